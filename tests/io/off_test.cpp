#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/diagnostics.h>
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

const std::string off_square = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
const std::string plain = "OFF\n4 2 0\n" + off_square + "3 0 1 2\n3 0 2 3\n";

/// Everything at once: prefixes, comments in all places, odd spacing and spellings, all kinds of face colour.
const std::string rich_off =
    "# made by hand\n"
    "STCNOFF # the keyword\n"
    "\n"
    "5  # vertices\n"
    "6 0 # faces, edges\n"
    "0.0 -0 0   0 0 1  255 0 10 255   0.50 .5\n"
    "  1. 0 0   0 0 1  255 0 10 0   1 0.5 # one\n"
    "1 1e0 0    0 0 1  25 0 10 255   1 1\n"
    "\t0 +1 0   0 0 1.0  255 100 10 255   0 1   \n"
    "0 2 0   0 0 1  255 0 10 255   0 2\n"
    "# the faces\n"
    "4 0 1 2 3\n"
    "3  0 1 2  12\n"
    "3 0 2 3 255 128 0 # red\n"
    "3 0 2 3 0.25 1.0 0\n"
    "3 0 2 3 1 0 0 0.5\n"
    "3 2 4 3 1 0 0";

std::vector<std::string> off_files() {
  return {plain,
          rich_off,
          "OFF 4 2 5\n" + off_square + "3 0 1 2\n3 0 2 3\n",
          "OFF4 2 5\n" + off_square + "3 0 1 2\n3 0 2 3\n",
          "OFF\n4 1\n" + off_square + "4 0 1 2 3\n",
          "OFF\n4\n1\n0\n" + off_square + "4 0 1 2 3\n",
          "4 1 0\n" + off_square + "4 0 1 2 3\n",
          "\xEF\xBB\xBFOFF\n4 1 0\n" + off_square + "4 0 1 2 3\n",
          "OFF\n4 1 0\n0 0 0 1 0 0\n1 1 0 0 1\n0\n4 0 1\n2 3\n",
          "COFF\n3 1 0\n0 0 0 1 0 0\n1 0 0 1 0 0\n0 1 0 0.5 0 0\n3 0 1 2\n",
          "NOFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
          "CNOFF\n1 0 0\n0 0 0 0 0 1 255 1 2\n",
          "NCOFF\n1 0 0\n0 0 0 0 0 1 255 1 2\n",
          "STOFF\n1 0 0\n0 0 0 0.5 1\n",
          "OFF\n0 0 0\n",
          "OFF\n1 2 0\nnan inf 0\n0\n1 0\n"};
}

TEST(Off, WithoutAnEditAFileComesBackByteForByte) {
  const TemporaryFolder folder;
  for (const std::string& file : off_files()) {
    for (const char* line_end : {"\n", "\r\n", "\r"}) {
      const std::string content = with_line_ends(file, line_end);
      SCOPED_TRACE(content);
      EXPECT_EQ(folder.written(folder.mesh("in.off", content), "out.off"), content);
    }
  }
}

TEST(Off, AMovedVertexChangesItsOwnNumbersOnly) {
  const TemporaryFolder folder;
  for (const std::string& file : off_files()) {
    SCOPED_TRACE(file);
    const Mesh before = folder.mesh("in.off", file);
    for (Index v = 0; v < before.vertex_count(); ++v) {
      Mesh mesh = before;
      mesh.positions.row(v) = Eigen::RowVector3d(0.1, -1.0 / 3, 1e-20 * (v + 1));
      const Mesh after = folder.mesh("again.off", folder.written(mesh, "out.off"));
      EXPECT_EQ(after.positions.row(v), mesh.positions.row(v));
      EXPECT_TRUE(after.faces == mesh.faces);
      Mesh back = after;
      back.positions.row(v) = before.positions.row(v);
      const Mesh original = folder.mesh("back.off", folder.written(back, "back.off"));
      for (Index w = 0; w < before.vertex_count(); ++w) {
        if (before.positions.row(w).allFinite()) {
          EXPECT_EQ(original.positions.row(w), before.positions.row(w));
        }
      }
    }
  }
}

TEST(Off, OnlyNewNumbersHaveNewText) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.off", rich_off);
  mesh.positions(1, 1) = 0.125;
  mesh.attributes[0].values[3 * 3 + 2] = -1;  // a normal
  mesh.attributes[1].values[4] = 7;           // a vertex colour
  std::string expected = rich_off;
  const auto replace = [&](const std::string& from, const std::string& to) {
    expected.replace(expected.find(from), from.size(), to);
  };
  replace("  1. 0 0   0 0 1  255 ", "  1. 0.125 0   0 0 1  7 ");
  replace("0 0 1.0  255", "0 0 -1  255");
  EXPECT_EQ(folder.written(mesh, "out.off"), expected);
}

TEST(Off, TheColoursOfFacesKeepTheirSpelling) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.off", rich_off);
  for (Attribute& attribute : mesh.attributes) {
    if (attribute.domain != Domain::face) continue;
    for (double& value : attribute.values) value = attribute.name == "colour" ? 0.2 : 3;
  }
  const std::string written = folder.written(mesh, "out.off");
  EXPECT_NE(written.find("3  0 1 2  3\n3 0 2 3 51 51 51 # red\n3 0 2 3 0.2 0.2 0.2\n3 0 2 3 0.2 0.2 0.2 0.2\n"),
            std::string::npos)
      << written;
}

TEST(Off, DataOfVerticesAndFacesBecomesAttributes) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh("in.off", rich_off);
  ASSERT_EQ(mesh.vertex_count(), 5);
  ASSERT_EQ(mesh.face_count(), 6);
  EXPECT_EQ(mesh.faces[0].size(), 4u);
  EXPECT_EQ(mesh.positions.row(3), Eigen::RowVector3d(0, 1, 0));

  const Attribute* normal = mesh.find_attribute(Domain::vertex, "normal");
  ASSERT_NE(normal, nullptr);
  EXPECT_EQ(normal->interpolation, Interpolation::direction);
  EXPECT_EQ(normal->values[2], 1);
  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_EQ(colour->components, 4);
  EXPECT_EQ(colour->type, ScalarType::uint8);
  EXPECT_EQ(colour->values[4 * 3 + 1], 100);
  const Attribute* uv = mesh.find_attribute(Domain::vertex, "uv");
  ASSERT_NE(uv, nullptr);
  EXPECT_EQ(uv->values[3], 0.5);

  const Attribute* face_colour = mesh.find_attribute(Domain::face, "colour");
  ASSERT_NE(face_colour, nullptr);
  EXPECT_EQ(face_colour->type, ScalarType::float32);
  EXPECT_EQ(face_colour->components, 4);
  EXPECT_TRUE(std::isnan(face_colour->values[0]));
  EXPECT_EQ(face_colour->values[4 * 2 + 1], 128 / 255.0);
  EXPECT_EQ(face_colour->values[4 * 3 + 1], 1);
  EXPECT_EQ(face_colour->values[4 * 4 + 3], 0.5);
  EXPECT_EQ(face_colour->values[4 * 5], 1);
  const Attribute* index = mesh.find_attribute(Domain::face, "colour_index");
  ASSERT_NE(index, nullptr);
  EXPECT_EQ(index->values[1], 12);
  EXPECT_TRUE(std::isnan(index->values[2]));
}

TEST(Off, ColoursOfThreeOrFourWholeNumbersAreBytes) {
  const TemporaryFolder folder;
  const Mesh mesh =
      folder.mesh("in.off", "COFF\n3 1 0\n0 0 0 200 0 0\n1 0 0 0 0 0\n0 1 0 0 0 1\n3 0 1 2 1 1 1\n");
  EXPECT_EQ(mesh.find_attribute(Domain::vertex, "colour")->type, ScalarType::uint8);
  EXPECT_EQ(mesh.find_attribute(Domain::vertex, "colour")->components, 3);
  EXPECT_EQ(mesh.find_attribute(Domain::face, "colour")->type, ScalarType::uint8);
  const Mesh fractions = folder.mesh("in.off", "COFF\n1 0 0\n0 0 0 1 0 0 1\n");
  EXPECT_EQ(fractions.find_attribute(Domain::vertex, "colour")->type, ScalarType::float32);
}

TEST(Off, AMeshWithoutAFileIsComposedAndReadsBack) {
  const TemporaryFolder folder;
  for (const std::string& file : off_files()) {
    Mesh mesh = folder.mesh("in.off", file);
    mesh.source = nullptr;
    const Mesh again = folder.mesh("again.off", folder.written(mesh, "out.off"));
    SCOPED_TRACE(read_file(folder / "out.off"));
    EXPECT_TRUE(again.faces == mesh.faces);
    ASSERT_EQ(again.attributes.size(), mesh.attributes.size());
    for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
      const Attribute& before = mesh.attributes[a];
      const Attribute* after = again.find_attribute(before.domain, before.name);
      ASSERT_NE(after, nullptr);
      EXPECT_EQ(after->type, before.type);
      ASSERT_EQ(after->values.size(), before.values.size());
      for (std::size_t k = 0; k < before.values.size(); ++k) {
        if (!std::isnan(before.values[k])) {
          EXPECT_NEAR(after->values[k], before.values[k], 1e-7);
        }
      }
    }
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      if (!mesh.positions.row(v).allFinite()) continue;
      EXPECT_EQ(again.positions.row(v), mesh.positions.row(v));
    }
  }
}

TEST(Off, DarkBytesStayBytesOfTheirValue) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.off", "COFF\n1 0 0\n0 0 0 200 0 0\n");
  mesh.source = nullptr;
  mesh.attributes[0].values = {1, 0, 1};
  const Mesh again = folder.mesh("again.off", folder.written(mesh, "out.off"));
  EXPECT_NEAR(again.attributes[0].values[0], 1 / 255.0, 1e-7);
}

TEST(Off, AttributesThatOffCannotHoldAreNamed) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh(
      "in.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\ng body\nusemtl skin\nf 1/1 2/1 3/1\n");
  const WriteResult result = write_mesh(mesh, folder / "out.off");
  ASSERT_EQ(result.notes.size(), 2u);
  EXPECT_EQ(result.notes[0].id(), "io.attributes_left_out");
  EXPECT_EQ(result.notes[0].text(), "OFF has no place for uv, group, material; a PLY file keeps them");
  EXPECT_EQ(result.notes[1].id(), "io.materials_left_out");
  EXPECT_EQ(result.notes[1].get<std::string>("library"), "a.mtl");
  EXPECT_EQ(read_file(folder / "out.off"), "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
}

TEST(Off, AFormatIsKnownByItsFirstWord) {
  const TemporaryFolder folder;
  EXPECT_EQ(folder.mesh("a.dat", plain).face_count(), 2);
  EXPECT_EQ(folder.mesh("a.obj", "STCNOFF\n0 0 0\n").face_count(), 0);
  EXPECT_EQ(folder.mesh("A.Off", "# first\nOFF 0 0 0\n").face_count(), 0);
}

TEST(Off, IndicesOutOfRangeAreLeftToCheckMesh) {
  const TemporaryFolder folder;
  const std::string file = "OFF\n1 2 0\n0 0 0\n3 0 7 -1\n1 0\n";
  const Mesh mesh = folder.mesh("in.off", file);
  EXPECT_EQ(mesh.faces[0][1], 7);
  EXPECT_FALSE(check_mesh(mesh).findings.empty());
  EXPECT_EQ(folder.written(mesh, "out.off"), file);
}

struct BadOff {
  const char* what;
  std::string content;
  const char* id;
  std::vector<std::string> words;
};

std::vector<BadOff> bad_off_files() {
  return {
      {"another format", "hello\n", "io.not_this_format", {"line 1", "'OFF'"}},
      {"four dimensions", "4OFF\n0 0 0\n", "io.unsupported_variant", {"line 1", "'4OFF'", "x, y and z"}},
      {"any dimension", "nOFF 5\n0 0 0\n", "io.unsupported_variant", {"line 1", "'nOFF'"}},
      {"binary",
       "OFF BINARY\n" + std::string(12, '\0'),
       "io.unsupported_variant",
       {"line 1", "'BINARY'", "OFF text"}},
      {"zeros", "OFF\n1 0 0\n0 0 0" + std::string(1, '\0'), "io.not_text", {"byte 15", "not text"}},
      {"no counts", "OFF\n", "io.truncated", {"vertex_count"}},
      {"negative count", "OFF\n-1 0 0\n", "io.bad_count", {"line 2", "'-1'", "'vertex'", "0 to 2147483647"}},
      {"huge count", "OFF\n1 99999999999 0\n", "io.bad_count", {"line 2", "'99999999999'", "'face'"}},
      {"lying count", "OFF\n2000000000 1 0\n0 0 0\n", "io.too_short", {"2000000000 'vertex'"}},
      {"lying count of faces", "OFF\n1 2000000000 0\n0 0 0\n", "io.too_short", {"2000000000 'face'"}},
      {"a vertex short",
       "OFF\n3 0 0\n0 0 0 # padding\n1 2 3\n",
       "io.truncated",
       {"line 5", "vertex 2", "cut off"}},
      {"a face short", "OFF\n1 2 0\n0 0 0\n3 0 0 0\n", "io.truncated", {"face 1", "cut off"}},
      {"a face too many", plain + "3 0 1 2\n", "io.trailing_data_of_off", {"line 9", "goes on"}},
      {"no number", "OFF\n1 0 0\n0 zero 0\n", "io.not_a_number", {"line 3", "vertex 0", "'zero'"}},
      {"decimal comma", "OFF\n1 0 0\n0 0,5 0\n", "io.decimal_comma", {"line 3", "'0,5'", "decimal point"}},
      {"fractional index",
       "OFF\n1 1 0\n0 0 0\n3 0 0 0.5\n",
       "io.not_a_whole_number",
       {"line 4", "face 0", "'0.5'", "whole number"}},
      {"colours unannounced",
       "OFF\n2 1 0\n0 0 0 .5 0 0\n1 0 0 .5 0 0\n3 0 1 0\n",
       "io.trailing_data_of_off",
       {"line 5", "goes on", "COFF"}},
      {"negative size", "OFF\n1 1 0\n0 0 0\n-3 0 0 0\n", "io.bad_length", {"line 4", "face 0", "-3"}},
      {"huge size",
       "OFF\n1 1 0\n0 0 0\n2000000000 0 0 0\n",
       "io.bad_length",
       {"line 4", "face 0", "2000000000"}},
      {"two colours", "OFF\n1 1 0\n0 0 0\n3 0 0 0 1 2\n", "io.bad_colour", {"line 4", "face 0", "no colour"}},
      {"five colours",
       "OFF\n1 1 0\n0 0 0\n3 0 0 0 1 2 3 4 5\n",
       "io.bad_colour",
       {"line 4", "face 0", "no colour"}},
      {"too bright", "OFF\n1 1 0\n0 0 0\n3 0 0 0 1 2 256\n", "io.bad_colour", {"line 4", "face 0", "255"}},
      {"a word as colour",
       "OFF\n1 1 0\n0 0 0\n3 0 0 0 red\n",
       "io.not_a_number",
       {"line 4", "face 0", "colour of face", "'red'"}},
      {"line after CR",
       with_line_ends("OFF\n1 0 0\n0 zero 0\n", "\r"),
       "io.not_a_number",
       {"line 3", "'zero'"}},
      {"line after CRLF",
       with_line_ends("OFF\n1 0 0\n0 zero 0\n", "\r\n"),
       "io.not_a_number",
       {"line 3", "'zero'"}},
  };
}

TEST(Off, BadFilesAreNamedWithPlaceAndRemedy) {
  const TemporaryFolder folder;
  for (const BadOff& bad : bad_off_files()) {
    SCOPED_TRACE(bad.what);
    const auto path = folder.file("bad.off", bad.content);
    std::vector<std::string> words = bad.words;
    words.push_back("bad.off");
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Off, DamagedFilesAreReadOrRefused) {
  const TemporaryFolder folder;
  expect_damage_is_survived(folder, "damaged.off", rich_off, 400);
  expect_damage_is_survived(folder, "damaged.off", plain, 200);
}

TEST(Off, ASampleKeepsShapeAndFacesThroughAllFormats) {
  const TemporaryFolder folder;
  const Mesh sample = make_sample("head", 24);
  Mesh mesh = sample;
  for (const char* name : {"a.off", "b.obj", "c.off", "d.ply", "e.off"}) {
    write_mesh(mesh, folder / name);
    mesh = read_mesh(folder / name);
    EXPECT_TRUE(mesh.positions == sample.positions) << name;
    EXPECT_TRUE(mesh.faces == sample.faces) << name;
    EXPECT_NE(mesh.find_attribute(Domain::vertex, "colour"), nullptr) << name;
  }
}

}  // namespace
}  // namespace meshgraft
