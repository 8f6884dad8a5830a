#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/samples/samples.h>

#include "damage.h"
#include "expect_error.h"
#include "io/file.h"
#include "temporary_folder.h"

namespace meshgraft {
namespace {

using test::expect_damage_is_survived;
using test::expect_error;
using test::TemporaryFolder;
using test::with_line_ends;

using Facet = std::array<float, 12>;

template <class T>
void put_value(std::string& bytes, T value) {
  auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
  if (std::endian::native == std::endian::big) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

std::string binary(const std::vector<Facet>& facets, std::string header = "made by hand",
                   const std::vector<std::uint16_t>& attributes = {}) {
  header.resize(80, ' ');
  put_value(header, static_cast<std::uint32_t>(facets.size()));
  for (std::size_t f = 0; f < facets.size(); ++f) {
    for (const float value : facets[f]) put_value(header, value);
    put_value(header, f < attributes.size() ? attributes[f] : std::uint16_t{0});
  }
  return header;
}

/// Two triangles of a square; the first normal is wrong, the second missing.
const std::vector<Facet> square = {Facet{1, 2, 3, 0, 0, 0, 1, 0, 0, 1, 1, 0},
                                   Facet{0, 0, 0, 0, -0.f, 0, 1, 1, 0, 0, 1, 0}};

const std::string ascii =
    "solid left  part\n"
    "  facet normal 0 0 1.0\n"
    "    outer loop\n"
    "      vertex 0 0 0.00\n"
    "      vertex 1e0 0 0\n"
    "      vertex 1 1 0\n"
    "    endloop\n"
    "  endfacet\n"
    "endsolid left  part\n"
    "\n"
    "SOLID\n"
    "FACET NORMAL 0 0 0\n"
    "OUTER LOOP VERTEX 0 -0 0 VERTEX 1.0 1 0 \tVERTEX 0 +1 0 ENDLOOP ENDFACET\n"
    "ENDSOLID";

std::vector<std::string> stl_files() {
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  return {binary(square),
          binary(square, "solid as many an ascii file"),
          binary(square, "COLOR=\xFF", {0x8001, 0}),
          binary({}),
          binary({Facet{nan, 0, 0, nan, 0, 0, nan, 0, 0, INFINITY, 1, 0}}),
          ascii,
          with_line_ends(ascii, "\r\n"),
          with_line_ends(ascii, "\r"),
          "\xEF\xBB\xBF" + ascii,
          "solid\nendsolid\n"};
}

TEST(Stl, WithoutAnEditAFileComesBackByteForByte) {
  const TemporaryFolder folder;
  for (const std::string& file : stl_files())
    EXPECT_EQ(folder.written(folder.mesh("in.stl", file), "out.stl"), file);
}

TEST(Stl, CornersAtOnePlaceAreOneVertex) {
  const TemporaryFolder folder;
  for (const std::string& file : {binary(square), ascii}) {
    const Mesh mesh = folder.mesh("in.stl", file);
    EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 2, 0, 2, 3}));
    EXPECT_EQ(mesh.positions, (Points(4, 3) << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0).finished());
  }
}

TEST(Stl, VerticesAtNanAreNotMerged) {
  const TemporaryFolder folder;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const Mesh mesh = folder.mesh("in.stl", binary({Facet{0, 0, 0, nan, 0, 0, nan, 0, 0, 1, 0, 0}}));
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 2}));
}

TEST(Stl, AMovedVertexChangesItsFacetsOnly) {
  const TemporaryFolder folder;
  const std::string file = binary(square, "solid, yet binary", {7, 8});
  Mesh mesh = folder.mesh("in.stl", file);
  mesh.positions.row(1) = Eigen::RowVector3d(1.25, 0.1, 0);
  std::vector<Facet> expected = square;
  expected[0] = Facet{0, 0, 1, 0, 0, 0, 1.25, 0.1f, 0, 1, 1, 0};
  EXPECT_EQ(folder.written(mesh, "out.stl"), binary(expected, "solid, yet binary", {7, 8}));
}

TEST(Stl, MinusZeroAndNanPayloadsOfOthersStay) {
  const TemporaryFolder folder;
  const float payload = std::bit_cast<float>(0x7FC12345u);
  const std::string file = binary({square[1], Facet{payload, 0, 0, payload, 0, 0, 5, 0, 0, 5, 1, 0}});
  Mesh mesh = folder.mesh("in.stl", file);
  mesh.positions(1, 2) = 1;  // a corner of the first facet, which also has a -0
  const std::string written = folder.written(mesh, "out.stl");
  EXPECT_EQ(written.substr(84 + 12, 12), file.substr(84 + 12, 12));
  EXPECT_EQ(written.substr(84 + 50), file.substr(84 + 50));
  EXPECT_NE(written, file);
}

TEST(Stl, InAsciiOnlyNewNumbersHaveNewText) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.stl", ascii);
  mesh.positions(1, 2) = -0.1;
  std::string expected = ascii;
  const auto replace = [&](const std::string& from, const std::string& to) {
    expected.replace(expected.find(from), from.size(), to);
  };
  replace("vertex 1e0 0 0", "vertex 1e0 0 -0.1");
  replace("normal 0 0 1.0", "normal 0.09901476 -0.09901476 0.990147");
  const std::string written = folder.written(mesh, "out.stl");
  // The last digits of the normal depend on the machine.
  const std::size_t normal = ascii.find("normal");
  EXPECT_EQ(written.substr(0, normal + 10), expected.substr(0, normal + 10));
  EXPECT_EQ(written.substr(written.find("outer")), expected.substr(expected.find("outer")));
}

TEST(Stl, MovedReadAndMovedAgainIsTheSame) {
  const TemporaryFolder folder;
  for (const bool from_binary : {true, false}) {
    Mesh mesh = make_sample("head", 24);
    if (from_binary) {
      write_mesh(mesh, folder / "in.stl");
    } else {
      std::string text = "solid head\n";
      for (Index f = 0; f < mesh.face_count(); ++f) {
        text += "facet normal 0 0 0\nouter loop\n";
        for (const Index v : mesh.faces[f]) {
          text += "vertex";
          for (int axis = 0; axis < 3; ++axis) text += ' ' + std::to_string(mesh.positions(v, axis));
          text += '\n';
        }
        text += "endloop\nendfacet\n";
      }
      folder.file("in.stl", text + "endsolid head\n");
    }
    const Mesh before = read_mesh(folder / "in.stl");
    EXPECT_EQ(before.vertex_count(), mesh.vertex_count());
    mesh = before;
    mesh.positions.topRows(100).array() += 0.25;
    write_mesh(mesh, folder / "out.stl");
    const Mesh after = read_mesh(folder / "out.stl");
    EXPECT_TRUE(after.faces == before.faces);
    EXPECT_LT((after.positions - mesh.positions).cwiseAbs().maxCoeff(), from_binary ? 1e-6 : 1e-300);
    EXPECT_TRUE(after.positions.bottomRows(after.vertex_count() - 100) ==
                before.positions.bottomRows(before.vertex_count() - 100));
  }
}

TEST(Stl, TheBytesBehindAFacetAreAnAttribute) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.stl", binary(square, "colours", {0, 0xFFFF}));
  const Attribute* attribute = mesh.find_attribute(Domain::face, "attribute");
  ASSERT_NE(attribute, nullptr);
  EXPECT_EQ(attribute->type, ScalarType::uint16);
  EXPECT_EQ(attribute->interpolation, Interpolation::nearest);
  EXPECT_EQ(attribute->values, (std::vector<double>{0, 65535}));
  mesh.attributes[0].values[0] = 3;
  EXPECT_EQ(folder.written(mesh, "out.stl"), binary(square, "colours", {3, 0xFFFF}));
  EXPECT_TRUE(folder.mesh("in.stl", binary(square)).attributes.empty());
}

TEST(Stl, SeveralSolidsAreObjects) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("in.stl", ascii);
  const Attribute* object = mesh.find_attribute(Domain::face, "object");
  ASSERT_NE(object, nullptr);
  EXPECT_EQ(object->labels, (std::vector<std::string>{"left  part", "solid_2"}));
  EXPECT_EQ(object->values, (std::vector<double>{0, 1}));
  const std::string one = ascii.substr(0, ascii.find("\nSOLID"));
  EXPECT_TRUE(folder.mesh("one.stl", one).attributes.empty());
}

TEST(Stl, TellsOfVerticesThatItCannotKeepApart) {
  const TemporaryFolder folder;
  const std::string sides =
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 0\nv 0 1 0\nv -1 0 0\nv 0 0 0\nf 1 2 3\nf 4 5 6\n";
  const WriteResult result = write_mesh(folder.mesh("in.obj", sides), folder / "out.stl");
  ASSERT_EQ(result.notes.size(), 2U);  // the last vertex has no face
  EXPECT_EQ(result.notes[0].id(), "io.vertices_joined");
  EXPECT_TRUE(result.notes[0].text().starts_with("2 vertices lie where others do")) << result.notes[0].text();
  EXPECT_EQ(read_mesh(folder / "out.stl").vertex_count(), 4);
}

TEST(Stl, MeshesOfOtherFormatsAreWrittenAsBinary) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.1 9 9\ng a\nf 1 2 3 4\nf 1 2\n");
  const WriteResult result = write_mesh(mesh, folder / "out.stl");
  const std::vector<std::string> expected = {
      "STL has no place for group; a PLY file keeps them", "STL has triangles only: 1 polygon is split",
      "STL has no place for vertices without a face: 1 is left out",
      "STL has no place for faces with fewer than three corners: 1 is left out"};
  std::vector<std::string> notes;
  for (const Note& note : result.notes) notes.push_back(note.text());
  EXPECT_EQ(notes, expected);
  const std::string written = read_file(folder / "out.stl");
  EXPECT_EQ(written.size(), 84u + 2 * 50);
  EXPECT_FALSE(written.starts_with("solid"));
  const Mesh again = read_mesh(folder / "out.stl");
  EXPECT_EQ(again.face_count(), 2);
  EXPECT_EQ(again.vertex_count(), 4);

  mesh.positions(1, 0) = 0.1;
  EXPECT_EQ(write_mesh(mesh, folder / "out.stl").notes.back().id(), "io.coordinates_rounded");
  mesh.positions(1, 0) = 1e300;
  expect_error([&] { write_mesh(mesh, folder / "out.stl"); }, "io.value_does_not_fit", {"vertex 1", "1e+300"});
}

TEST(Stl, TheHeaderOfTheOneFileBehindStays) {
  const TemporaryFolder folder;
  const auto header_of = [&](const std::string& header) {
    Mesh mesh = folder.mesh("in.stl", binary(square, header, {5, 6}));
    Faces one;
    one.push_back(mesh.faces[1]);
    mesh.faces = one;
    mesh.attributes[0].values = {6};
    const std::string written = folder.written(mesh, "out.stl");
    EXPECT_EQ(written.size(), 84u + 50);
    EXPECT_EQ(written.substr(written.size() - 2), std::string("\6\0", 2));
    return written.substr(0, 5);
  };
  EXPECT_EQ(header_of("COLOR=abcd"), "COLOR");
  EXPECT_EQ(header_of("solid"), "binar");
}

TEST(Stl, FilesAreToldApartBySizeThenByTheirFirstWord) {
  const TemporaryFolder folder;
  for (const char* name : {"a.stl", "a.obj", "a.dat"}) {
    EXPECT_EQ(folder.mesh(name, binary(square, "solid")).face_count(), 2);
    EXPECT_EQ(folder.mesh(name, ascii).face_count(), 2);
  }
}

struct BadStl {
  const char* what;
  std::string content;
  const char* id;
  std::vector<std::string> words;
};

std::vector<BadStl> bad_stl_files() {
  const auto with = [](const std::string& from, const std::string& to) {
    std::string text = ascii;
    return text.replace(text.find(from), from.size(), to);
  };
  const std::string whole = binary(square);
  std::string lying = whole;
  lying.replace(80, 4, "\xFF\xFF\xFF\xFF");
  return {
      {"another format", "v 0 0 0\n", "io.not_this_format", {"line 1", "'solid'"}},
      {"cut header", std::string(20, '\0'), "io.truncated_header", {"84 bytes"}},
      {"cut", whole.substr(0, whole.size() - 1), "io.wrong_size", {"2 facets", "184 bytes", "183", "cut off"}},
      {"trailing", whole + '\0', "io.wrong_size", {"2 facets", "185", "count is wrong"}},
      {"cut, named solid",
       binary(square, std::string("solid\0", 6)).substr(0, 150),
       "io.wrong_size",
       {"2 facets", "cut off"}},
      {"lying count", lying, "io.wrong_size", {"4294967295 facets", "byte 80"}},
      {"no facet",
       with("facet normal", "triangle normal"),
       "io.unexpected_word",
       {"line 2", "'triangle'", "endsolid, facet"}},
      {"no normal", with("normal", "direction"), "io.unexpected_word", {"line 2", "'direction'", "normal"}},
      {"no loop", with("outer loop", "vertex"), "io.unexpected_word", {"line 3", "'vertex'", "outer"}},
      {"four corners",
       with("    endloop", "    vertex 0 1 0"),
       "io.unexpected_word",
       {"line 7", "'vertex'", "endloop"}},
      {"no endloop", with("    endloop\n", ""), "io.unexpected_word", {"line 7", "'endfacet'", "endloop"}},
      {"no endfacet", with("  endfacet\n", ""), "io.unexpected_word", {"line 8", "'endsolid'", "endfacet"}},
      {"no endsolid", ascii.substr(0, ascii.size() - 8), "io.truncated", {"line 14", "ends", "'endsolid'"}},
      {"no number", with("1e0", "one"), "io.not_a_number", {"line 5", "'one'", "vertex of facet"}},
      {"decimal comma", with("1e0", "1,0"), "io.decimal_comma", {"line 5", "'1,0'", "decimal point"}},
      {"bad normal", with("0 0 1.0", "0 0 up"), "io.not_a_number", {"line 2", "'up'", "normal"}},
      {"too few numbers", with("vertex 1e0 0 0", "vertex 1e0 0"), "io.not_a_number", {"line 6", "'vertex'"}},
      {"something behind", ascii + " x\nmore", "io.unexpected_word", {"line 15", "'more'", "solid"}},
      {"line after CR", with_line_ends(with("1e0", "one"), "\r"), "io.not_a_number", {"line 5", "'one'"}},
  };
}

TEST(Stl, BadFilesAreNamedWithPlaceAndRemedy) {
  const TemporaryFolder folder;
  for (const BadStl& bad : bad_stl_files()) {
    SCOPED_TRACE(bad.what);
    const auto path = folder.file("bad.stl", bad.content);
    std::vector<std::string> words = bad.words;
    words.push_back("bad.stl");
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Stl, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  expect_damage_is_survived(folder, "damaged.stl", ascii, 400);
  expect_damage_is_survived(folder, "damaged.stl", binary(square), 400);
}

TEST(Stl, ASampleKeepsShapeAndFacesThroughAllFormats) {
  const TemporaryFolder folder;
  write_mesh(make_sample("torus", 24), folder / "first.stl");
  const Mesh first = read_mesh(folder / "first.stl");
  Mesh mesh = first;
  for (const char* name : {"a.ply", "b.stl", "c.obj", "d.stl", "e.off", "f.stl"}) {
    write_mesh(mesh, folder / name);
    mesh = read_mesh(folder / name);
    EXPECT_TRUE(mesh.positions == first.positions) << name;
    EXPECT_TRUE(mesh.faces == first.faces) << name;
  }
}

TEST(Stl, ABinaryHeaderMayBeginLikeAnotherFormat) {
  const TemporaryFolder folder;
  for (const std::string start : {"OFF road vehicle", "glTF converted", "ply\nformat", "PK\x03\x04", "solid"}) {
    const std::string file = binary(square, start);
    EXPECT_EQ(folder.written(folder.mesh("a.stl", file), "b.stl"), file) << start;
  }
}

}  // namespace
}  // namespace meshgraft
