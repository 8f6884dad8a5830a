#include <algorithm>
#include <array>
#include <bit>
#include <clocale>
#include <cmath>
#include <cstring>
#include <limits>
#include <locale>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/samples/samples.h>

#include "damage.h"
#include "expect_error.h"
#include "temporary_folder.h"

namespace meshgraft {
namespace {

using test::expect_error;
using test::TemporaryFolder;
using test::with_line_ends;

/// Bytes of a binary body.
class Bytes {
 public:
  explicit Bytes(bool big_endian) : swap_(big_endian == (std::endian::native == std::endian::little)) {}

  template <class T>
  Bytes& put(T value) {
    auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
    if (swap_) std::reverse(bytes.begin(), bytes.end());
    text_.append(bytes.data(), bytes.size());
    return *this;
  }
  template <class T>
  Bytes& put(std::initializer_list<T> values) {
    for (const T value : values) put(value);
    return *this;
  }
  const std::string& text() const { return text_; }

 private:
  bool swap_;
  std::string text_;
};

/// A file with everything: comments, foreign properties and elements, lists of several kinds.
std::string rich_header(const char* format) {
  return std::string("ply\nformat ") + format +
         " 1.0\n"
         "comment made by hand\n"
         "obj_info num_cols 512\n"
         "comment TextureFile skin.png\n"
         "element camera 1\n"
         "property float view_px\n"
         "property list uchar short lens\n"
         "element vertex 4\n"
         "property uchar red\n"
         "property uchar green\n"
         "property uchar blue\n"
         "property float x\n"
         "property double quality\n"
         "property float y\n"
         "property float z\n"
         "property float nx\n"
         "property float ny\n"
         "property float nz\n"
         "property short flags\n"
         "element tristrips 1\n"
         "property list int int vertex_indices\n"
         "element face 2\n"
         "property int group\n"
         "property list uchar int vertex_indices\n"
         "property list uchar float texcoord\n"
         "property list uchar uchar marks\n"
         "element edge 1\n"
         "property int vertex1\n"
         "property int vertex2\n"
         "end_header\n";
}

std::string rich_binary(bool big_endian) {
  Bytes bytes(big_endian);
  bytes.put(1.5f).put<std::uint8_t>(2).put<std::int16_t>({-7, 300});
  for (int v = 0; v < 4; ++v) {
    bytes.put<std::uint8_t>({static_cast<std::uint8_t>(10 * v), 20, 255});
    bytes.put(static_cast<float>(v % 2) + 0.1f).put(0.1 * v).put(static_cast<float>(v / 2)).put(0.f);
    bytes.put({0.f, 0.f, 1.f}).put<std::int16_t>(static_cast<std::int16_t>(-v));
  }
  bytes.put<std::int32_t>({5, 0, 1, 2, 3, -1});
  bytes.put<std::int32_t>(7).put<std::uint8_t>(3).put<std::int32_t>({0, 1, 3});
  bytes.put<std::uint8_t>(6).put({0.f, 0.f, 1.f, 0.f, 1.f, 1.f}).put<std::uint8_t>({2, 8, 9});
  bytes.put<std::int32_t>(9).put<std::uint8_t>(3).put<std::int32_t>({0, 3, 2});
  bytes.put<std::uint8_t>(6).put({.5f, 0.f, 1.f, 1.f, 0.f, 1.f}).put<std::uint8_t>(0);
  bytes.put<std::int32_t>({0, 3});
  return rich_header(big_endian ? "binary_big_endian" : "binary_little_endian") + bytes.text();
}

std::string rich_ascii() {
  return rich_header("ascii") +
         "1.50 2 -7 300\n"
         "0 20 255  0.1 0.0 0 0  0 0 1 0\n"
         "10 20 255  1.1 0.1 0 0  0 0 1 -1 \n"
         "20 20 255  0.10 0.2 1 0  0 0 1 -2\n"
         "30 20 255\t1.1 0.30000000000000004 1 0  0 0 1 -3\n"
         "5 0 1 2 3 -1\n"
         "7 3 0 1 3 6 0 0 1 0 1 1 2 8 9\n"
         "9 3 0 3 2 6 .5 0 1 1 0 1 0\n"
         "0 3\n";
}

void expect_rich_ply(const Mesh& mesh) {
  ASSERT_EQ(mesh.vertex_count(), 4);
  ASSERT_EQ(mesh.face_count(), 2);
  EXPECT_EQ(mesh.positions(3, 0), double{1.1f});
  EXPECT_EQ(mesh.positions(3, 1), 1.0);
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 3, 0, 3, 2}));

  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  ASSERT_NE(colour, nullptr);
  EXPECT_EQ(colour->components, 3);
  EXPECT_EQ(colour->type, ScalarType::uint8);
  EXPECT_EQ(colour->values[3 * 2], 20);
  EXPECT_EQ(colour->source_names, (std::vector<std::string>{"red", "green", "blue"}));
  const Attribute* normal = mesh.find_attribute(Domain::vertex, "normal");
  ASSERT_NE(normal, nullptr);
  EXPECT_EQ(normal->interpolation, Interpolation::direction);
  EXPECT_EQ(normal->values[2], 1);
  const Attribute* quality = mesh.find_attribute(Domain::vertex, "quality");
  ASSERT_NE(quality, nullptr);
  EXPECT_EQ(quality->interpolation, Interpolation::linear);
  EXPECT_EQ(quality->values[3], 0.1 * 3);
  const Attribute* flags = mesh.find_attribute(Domain::vertex, "flags");
  ASSERT_NE(flags, nullptr);
  EXPECT_EQ(flags->interpolation, Interpolation::nearest);
  EXPECT_EQ(flags->values[3], -3);
  const Attribute* group = mesh.find_attribute(Domain::face, "group");
  ASSERT_NE(group, nullptr);
  EXPECT_EQ(group->values, (std::vector<double>{7, 9}));
  const Attribute* uv = mesh.find_attribute(Domain::corner, "uv");
  ASSERT_NE(uv, nullptr);
  EXPECT_EQ(uv->components, 2);
  EXPECT_EQ(uv->values[6], 0.5);  // vertex 0 has another uv in face 1: a seam
  EXPECT_EQ(mesh.find_attribute(Domain::corner, "marks"), nullptr);
}

TEST(Ply, AllEncodingsAndLineEndsReadAlikeAndComeBackByteForByte) {
  const TemporaryFolder folder;
  std::vector<std::string> files = {rich_binary(false), rich_binary(true)};
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    files.push_back(with_line_ends(rich_ascii(), line_end));
    files.push_back("\xEF\xBB\xBF" + files.back());
  }
  std::string no_last_line_end = rich_ascii();
  no_last_line_end.pop_back();
  files.push_back(no_last_line_end);
  files.push_back(rich_ascii() + "\n \n");
  for (std::size_t k = 0; k < files.size(); ++k) {
    SCOPED_TRACE(k);
    const Mesh mesh = folder.mesh("in.ply", files[k]);
    expect_rich_ply(mesh);
    EXPECT_EQ(folder.written(mesh, "out.ply"), files[k]);
  }
}

TEST(Ply, BinaryHeadersMayEndTheirLinesInAnyWay) {
  const TemporaryFolder folder;
  // The first byte of the data is a line feed: after a lone CR it must not be taken for the line's end.
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty uchar red\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n";
  const std::string data = "\n" + Bytes(false).put({1.f, 2.f, 3.f}).text();
  for (const char* line_end : {"\n", "\r\n", "\r"}) {
    const std::string file = with_line_ends(header, line_end) + data;
    const Mesh mesh = folder.mesh("in.ply", file);
    EXPECT_EQ(mesh.positions, (Points(1, 3) << 1, 2, 3).finished());
    EXPECT_EQ(mesh.find_attribute(Domain::vertex, "red")->values, std::vector<double>{10});
    EXPECT_EQ(folder.written(mesh, "out.ply"), file);
  }
}

TEST(Ply, AnEditChangesTheBytesOfMovedCoordinatesOnly) {
  const TemporaryFolder folder;
  for (const bool big_endian : {false, true}) {
    const std::string file = rich_binary(big_endian);
    Mesh mesh = folder.mesh("in.ply", file);
    mesh.positions(2, 1) = 0.3;  // is written as the nearest float
    const std::string written = folder.written(mesh, "out.ply");
    ASSERT_EQ(written.size(), file.size());
    // The camera takes 9 bytes (4+1+4). A vertex record has 37 bytes; its y begins at byte 15.
    const std::size_t record = 3 + 4 + 8 + 4 + 4 + 12 + 2;
    const std::size_t y =
        rich_header(big_endian ? "binary_big_endian" : "binary_little_endian").size() + 9 + 2 * record + 15;
    const std::string expected = Bytes(big_endian).put(0.3f).text();
    EXPECT_EQ(written.substr(y, 4), expected);
    std::string restored = written;
    restored.replace(y, 4, file, y, 4);
    EXPECT_EQ(restored, file);
    EXPECT_EQ(folder.mesh("again.ply", written).positions(2, 1), double{0.3f});
  }
}

TEST(Ply, AnEditOfTextChangesTheWordsOfMovedCoordinatesOnly) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.ply", with_line_ends(rich_ascii(), "\r\n"));
  mesh.positions(1, 0) = 0.1;
  mesh.positions(3, 2) = -2;
  std::string expected = rich_ascii();
  expected.replace(expected.find("  1.1 0.1 0 0"), 13, "  0.1 0.1 0 0");
  expected.replace(expected.find("0.30000000000000004 1 0"), 23, "0.30000000000000004 1 -2");
  EXPECT_EQ(folder.written(mesh, "out.ply"), with_line_ends(expected, "\r\n"));
}

TEST(Ply, NewNormalsAndOtherAttributeValuesAreWritten) {
  const TemporaryFolder folder;
  for (const std::string& file : {rich_binary(false), rich_binary(true), rich_ascii()}) {
    Mesh mesh = folder.mesh("in.ply", file);
    for (Attribute& attribute : mesh.attributes) {
      if (attribute.name == "normal") attribute.values[1] = 0.6;
      if (attribute.name == "uv") attribute.values[7] = 0.25;
      if (attribute.name == "colour") attribute.values[0] = 99.6;  // a mean of two colours: rounded
    }
    const Mesh again = folder.mesh("again.ply", folder.written(mesh, "out.ply"));
    EXPECT_EQ(again.find_attribute(Domain::vertex, "normal")->values[1], double{0.6f});
    EXPECT_EQ(again.find_attribute(Domain::corner, "uv")->values[7], 0.25);
    EXPECT_EQ(again.find_attribute(Domain::vertex, "colour")->values[0], 100);
    EXPECT_TRUE(again.positions == mesh.positions);
  }
}

TEST(Ply, DoublesKeepEveryBit) {
  const TemporaryFolder folder;
  const std::string header =
      "element vertex 1\nproperty double x\nproperty double y\nproperty double z\nend_header\n";
  const std::string binary =
      "ply\nformat binary_big_endian 1.0\n" + header + Bytes(true).put({1., 2., 3.}).text();
  const std::string ascii = "ply\nformat ascii 1.0\n" + header + "1 2 3\n";
  const Points wanted = (Points(1, 3) << 1.0 / 3, 1e9 + 1.0 / 7, -5e-324).finished();
  for (const std::string& file : {binary, ascii}) {
    Mesh mesh = folder.mesh("in.ply", file);
    mesh.positions = wanted;
    const Mesh again = folder.mesh("again.ply", folder.written(mesh, "out.ply"));
    EXPECT_EQ(std::memcmp(again.positions.data(), wanted.data(), 3 * sizeof(double)), 0);
  }
}

TEST(Ply, EveryScalarTypeIsReadAndKept) {
  const TemporaryFolder folder;
  const std::string types[] = {"char", "uchar", "short", "ushort", "int",   "uint",   "float",   "double",
                               "int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
  std::string header = "element vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  std::string row = "0 0 0";
  for (int k = 0; k < 16; ++k) {
    header += "property " + types[k] + " p" + std::to_string(k) + "\n";
    row += " " + std::to_string(100 + k);
  }
  const std::string file = "ply\nformat ascii 1.0\n" + header + "end_header\n" + row + "\n";
  Mesh mesh = folder.mesh("in.ply", file);
  EXPECT_EQ(folder.written(mesh, "out.ply"), file);
  mesh.source = nullptr;
  const Mesh again = folder.mesh("again.ply", folder.written(mesh, "composed.ply"));
  for (int k = 0; k < 16; ++k) {
    const Attribute* attribute = again.find_attribute(Domain::vertex, "p" + std::to_string(k));
    ASSERT_NE(attribute, nullptr);
    EXPECT_EQ(attribute->values[0], 100 + k);
    EXPECT_EQ(attribute->type, static_cast<ScalarType>(k % 8));
  }
}

TEST(Ply, SpecialNumbersAreReadAsSuch) {
  const TemporaryFolder folder;
  const std::string file =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\n"
      "property double z\nend_header\nnan NaN -nan(ind)\ninf -Infinity +1.5\n1.#QNAN 1.#INF 1e-400\n";
  const Mesh mesh = folder.mesh("in.ply", file);
  for (const auto& [row, column] : {std::pair{0, 0}, {0, 1}, {0, 2}, {2, 0}}) {
    EXPECT_TRUE(std::isnan(mesh.positions(row, column)));
  }
  EXPECT_EQ(mesh.positions(1, 0), std::numeric_limits<double>::infinity());
  EXPECT_EQ(mesh.positions(1, 1), -std::numeric_limits<double>::infinity());
  EXPECT_EQ(mesh.positions(1, 2), 1.5);
  EXPECT_EQ(mesh.positions(2, 1), std::numeric_limits<double>::infinity());
  EXPECT_EQ(mesh.positions(2, 2), 0);
  EXPECT_EQ(folder.written(mesh, "out.ply"), file);
}

TEST(Ply, TriangleStripsAreReadAsTriangles) {
  const TemporaryFolder folder;
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 6\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 2\nproperty list int int vertex_indices\n";
  const std::string body = "0 0 0\n0 1 0\n1 0 0\n1 1 0\n2 0 0\n2 1 0\n9 0 1 2 3 4 -1 2 3 5\n5 3 3 5 4 4\n";
  const std::string content = header + "end_header\n" + body;
  const Mesh mesh = folder.mesh("strips.ply", content);
  const std::vector<std::vector<Index>> expected{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}, {2, 3, 5}, {5, 3, 4}};
  ASSERT_EQ(mesh.face_count(), 5);
  for (Index f = 0; f < 5; ++f)
    EXPECT_TRUE(std::ranges::equal(mesh.faces[f], expected[static_cast<std::size_t>(f)])) << f;
  EXPECT_EQ(folder.written(mesh, "again.ply"), content);
  Mesh moved = mesh;
  moved.positions(5, 2) = 3;
  EXPECT_EQ(folder.mesh("moved.ply", folder.written(moved, "moved_out.ply")).faces, mesh.faces);
  // In a file with faces and strips, the faces are the surface.
  const std::string both =
      header + "element face 1\nproperty list uchar int vertex_indices\nend_header\n" + body + "3 0 2 4\n";
  EXPECT_EQ(folder.mesh("both.ply", both).face_count(), 1);
}

TEST(Ply, PolygonsStayPolygons) {
  const TemporaryFolder folder;
  const std::string file =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar uint vertex_index\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n.5 2 0\n4 0 1 2 3\n3 2 4 3\n";
  Mesh mesh = folder.mesh("in.ply", file);
  ASSERT_EQ(mesh.faces[0].size(), 4u);
  ASSERT_EQ(mesh.faces[1].size(), 3u);
  EXPECT_EQ(folder.written(mesh, "out.ply"), file);
  mesh.source = nullptr;
  EXPECT_TRUE(folder.mesh("again.ply", folder.written(mesh, "composed.ply")).faces == mesh.faces);
}

TEST(Ply, PointCloudsAndElementsWithoutPropertiesAreFine) {
  const TemporaryFolder folder;
  const std::string file =
      "ply\nformat ascii 1.0\nelement nothing 3\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n1 2 3\n";
  const Mesh mesh = folder.mesh("in.ply", file);
  EXPECT_EQ(mesh.face_count(), 0);
  EXPECT_EQ(folder.written(mesh, "out.ply"), file);
}

TEST(Ply, AMeshWithoutAFileIsComposedWithItsAttributes) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.ply", rich_ascii());
  mesh.source = nullptr;
  const Mesh again = folder.mesh("again.ply", folder.written(mesh, "out.ply"));
  expect_rich_ply(again);
  EXPECT_TRUE(again.positions == mesh.positions);
  EXPECT_EQ(read_file(folder / "out.ply").find("format binary_little_endian 1.0"), 4u);
  EXPECT_NE(read_file(folder / "out.ply").find("property double x"), std::string::npos);
}

TEST(Ply, AChangedTopologyIsComposedInTheFilesOwnPrecision) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.ply", rich_ascii());
  Faces faces;
  faces.push_back(std::array<Index, 4>{0, 1, 3, 2});
  mesh.faces = faces;
  const Mesh again = folder.mesh("again.ply", folder.written(mesh, "out.ply"));
  EXPECT_TRUE(again.faces == faces);
  EXPECT_TRUE(again.positions == mesh.positions);
  EXPECT_EQ(again.find_attribute(Domain::face, "group"), nullptr) << "values of faces that are gone";
  EXPECT_NE(read_file(folder / "out.ply").find("property float x"), std::string::npos);
}

TEST(Ply, AValueThatTheFilesTypeCannotHoldIsRefused) {
  const TemporaryFolder folder;
  Mesh mesh = folder.mesh("in.ply", rich_binary(false));
  mesh.positions(2, 0) = 1e300;
  expect_error([&] { write_mesh(mesh, folder / "out.ply"); }, "io.value_does_not_fit",
               {"out.ply", "vertex 2", "1e+300", "'x'", "float"});
  EXPECT_FALSE(std::filesystem::exists(folder / "out.ply"));
}

TEST(Ply, IndicesOutOfRangeAreReadForCheckMeshToName) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh(
      "in.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 -1 70\n");
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, -1, 70}));
}

struct BadPly {
  const char* what;
  std::string content;
  const char* id;
  std::vector<std::string> words;  // that the message contains
};

std::string vertices(const std::string& rows, int count = 1) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count) +
         "\nproperty float x\nproperty float y\nproperty float z\nend_header\n" + rows;
}

std::string faces(const std::string& row, const std::string& types = "char int") {
  return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list " +
         types + " vertex_indices\nend_header\n0 0 0\n" + row;
}

std::vector<BadPly> bad_ply_files() {
  const std::string binary = rich_binary(false);
  const std::size_t data = rich_header("binary_little_endian").size();
  std::string negative_list = faces("", "char int");
  negative_list.replace(negative_list.find("ascii"), 5, "binary_little_endian");
  negative_list.replace(negative_list.find("0 0 0\n"), 6,
                        Bytes(false).put({0.f, 0.f, 0.f}).text() + "\xFF\x01\x02\x03");
  return {
      {"no signature",
       "plx\nformat ascii 1.0\n",
       "io.not_this_format",
       {"line 1", "does not begin with 'ply'"}},
      {"header cut off", "ply\nformat ascii 1.0\nelement ver", "io.truncated", {"end_header", "cut off"}},
      {"only the signature", "ply", "io.truncated", {"end_header"}},
      {"no format",
       "ply\nelement vertex 1\nend_header\n",
       "io.unexpected_word",
       {"line 2", "'element'", "format"}},
      {"unknown format",
       "ply\nformat binary_middle_endian 1.0\nend_header\n",
       "io.unexpected_word",
       {"line 2", "binary_middle_endian"}},
      {"unknown version", "ply\nformat ascii 2.0\nend_header\n", "io.unexpected_word", {"line 2", "'2.0'"}},
      {"unknown keyword",
       "ply\nformat ascii 1.0\nelephant\nend_header\n",
       "io.unexpected_word",
       {"line 3", "'elephant'"}},
      {"unknown type",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\nend_header\n",
       "io.unexpected_word",
       {"line 4", "'half'"}},
      {"property before element",
       "ply\nformat ascii 1.0\nproperty float x\nend_header\n",
       "io.unexpected_word",
       {"line 3", "element"}},
      {"malformed property",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float\nend_header\n",
       "io.malformed_line",
       {"line 4", "property"}},
      {"float list length",
       "ply\nformat ascii 1.0\nelement face 1\nproperty list float int v\nend_header\n",
       "io.non_integer_type",
       {"line 4", "'v'", "length"}},
      {"malformed element",
       "ply\nformat ascii 1.0\nelement vertex\nend_header\n",
       "io.malformed_line",
       {"line 3", "COUNT"}},
      {"negative count",
       "ply\nformat ascii 1.0\nelement vertex -3\nend_header\n",
       "io.bad_count",
       {"line 3", "'-3'"}},
      {"huge count",
       "ply\nformat ascii 1.0\nelement vertex 99999999999999999999\nend_header\n",
       "io.bad_count",
       {"line 3", "99999999999999999999"}},
      {"element twice",
       "ply\nformat ascii 1.0\nelement vertex 0\nelement vertex 0\nend_header\n",
       "io.duplicate_element",
       {"line 4", "twice"}},
      {"no vertices", "ply\nformat ascii 1.0\nend_header\n", "io.no_vertices", {"'vertex'"}},
      {"no z",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nend_header\n0 0\n",
       "io.missing_property",
       {"'z'"}},
      {"lying count", vertices("0 0 0\n", 2000000000), "io.too_short", {"2000000000", "too short", "cut off"}},
      {"one row short",
       vertices("0 0 0\n111.1 222.2 333.3\n", 3),
       "io.truncated_records",
       {"line 10", "after 2 of 3", "cut off"}},
      {"one row too many", vertices("0 0 0\n0 0 0\n", 1), "io.trailing_data", {"line 9", "goes on"}},
      {"too few values", vertices("0 0 0\n1.1234 0\n", 2), "io.missing_value", {"line 9", "too few", "'z'"}},
      {"too many values", vertices("0 0 0 0\n"), "io.extra_values", {"line 8", "more values"}},
      {"no number", vertices("0 zero 0\n"), "io.not_a_number", {"line 8", "y of vertex", "'zero'"}},
      {"decimal comma", vertices("0,5 1 2\n"), "io.decimal_comma", {"line 8", "'0,5'", "decimal point"}},
      {"too large", vertices("1e39 1 2\n"), "io.number_out_of_range", {"line 8", "'1e39'", "range"}},
      {"line after CR", with_line_ends(vertices("0 zero 0\n"), "\r"), "io.not_a_number", {"line 8", "'zero'"}},
      {"line after CRLF",
       with_line_ends(vertices("0 zero 0\n"), "\r\n"),
       "io.not_a_number",
       {"line 8", "'zero'"}},
      {"negative list", faces("-1 0 0\n"), "io.bad_length", {"line 11", "vertex_indices", "-1"}},
      {"negative binary list", negative_list, "io.bad_length", {"face 0", "byte", "-1"}},
      {"overlong list", faces("2000000000 0 0\n", "int int"), "io.bad_length", {"line 11", "2000000000"}},
      {"list cut short", faces("3 0 0\n"), "io.missing_value", {"line 11", "too few"}},
      {"fractional index", faces("3 0 0 0.5\n"), "io.not_a_whole_number", {"line 11", "'0.5'", "whole number"}},
      {"index too large",
       faces("3 0 0 3000000000\n", "uchar uint"),
       "io.index_too_large",
       {"line 11", "3000000000"}},
      {"count out of its type", faces("200 0 0\n", "char int"), "io.number_out_of_range", {"line 11", "'200'"}},
      {"float indices", faces("3 0 0 0\n", "uchar float"), "io.non_integer_type", {"vertex_indices"}},
      {"binary cut in the header's elements", binary.substr(0, data + 3), "io.too_short", {"too short"}},
      {"binary cut in the middle",
       binary.substr(0, binary.size() - 20),
       "io.truncated_records",
       {"after 1 of 2 'face'"}},
      {"binary cut at the end", binary.substr(0, binary.size() - 1), "io.truncated_records", {"edge"}},
      {"binary with more",
       binary + "more",
       "io.trailing_data",
       {"byte " + std::to_string(binary.size()), "goes on"}},
  };
}

TEST(Ply, BadFilesAreNamedWithPlaceAndRemedy) {
  const TemporaryFolder folder;
  for (const BadPly& bad : bad_ply_files()) {
    SCOPED_TRACE(bad.what);
    const auto path = folder.file("bad.ply", bad.content);
    std::vector<std::string> words = bad.words;
    words.push_back("bad.ply");
    const Error error = expect_error([&] { read_mesh(path); }, bad.id, words);
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_FALSE(error.remedy().empty());
  }
}

TEST(Ply, AFileCutAnywhereIsRefusedOrWhole) {
  const TemporaryFolder folder;
  for (const std::string& file : {rich_binary(false), rich_binary(true), rich_ascii()}) {
    // The last digits of the text can be lost without a trace; in binary no byte can.
    const bool ascii = file.find("ascii") != std::string::npos;
    const std::size_t end = ascii ? file.size() - 3 : file.size();
    for (std::size_t size = 1; size < end; ++size) {
      const auto path = folder.file("cut.ply", std::string_view(file).substr(0, size));
      EXPECT_THROW(read_mesh(path), Error) << "cut after " << size << " bytes";
    }
  }
}

TEST(Ply, DamagedBytesNeverCrash) {
  const TemporaryFolder folder;
  for (const std::string& file : {rich_binary(false), rich_ascii()}) {
    for (std::size_t at = 0; at < file.size(); ++at) {
      for (const char damage : {'\xFF', '\0', '-', '9', '\n'}) {
        std::string damaged = file;
        damaged[at] = damage;
        const auto path = folder.file("damaged.ply", damaged);
        try {
          const Mesh mesh = read_mesh(path);
          if (at % 16 == 0) {
            EXPECT_EQ(folder.written(mesh, "out.ply"), damaged);
          }
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
        }
      }
    }
  }
}

/// Faces of three, four and two corners between scalars.
template <class Count, class Corner>
std::string binary_polygons(const char* count_type, const char* corner_type, bool big_endian) {
  Bytes bytes(big_endian);
  for (int k = 0; k < 12; ++k) bytes.put(static_cast<double>(k));
  for (const std::vector<int>& face : {std::vector{0, 1, 2}, std::vector{0, 1, 2, 3}, std::vector{1, 3}}) {
    bytes.put<std::int16_t>(static_cast<std::int16_t>(100 * face[1])).put(static_cast<Count>(face.size()));
    for (const int corner : face) bytes.put(static_cast<Corner>(corner));
    bytes.put(static_cast<float>(face.size()) / 4);
  }
  return std::string("ply\nformat ") + (big_endian ? "binary_big_endian" : "binary_little_endian") +
         " 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
         "element face 3\nproperty short before\nproperty list " +
         count_type + " " + corner_type + " vertex_indices\nproperty float behind\nend_header\n" + bytes.text();
}

std::vector<std::string> binary_polygon_files() {
  std::vector<std::string> files;
  for (const bool big_endian : {false, true}) {
    files.push_back(binary_polygons<std::uint8_t, std::int32_t>("uchar", "int", big_endian));
    files.push_back(binary_polygons<std::int8_t, std::uint32_t>("char", "uint", big_endian));
    files.push_back(binary_polygons<std::uint32_t, std::int16_t>("uint", "short", big_endian));
    files.push_back(binary_polygons<std::uint16_t, std::uint8_t>("ushort", "uchar", big_endian));
  }
  return files;
}

TEST(Ply, BinaryPolygonsOfAllTypesAreRead) {
  const TemporaryFolder folder;
  for (const std::string& file : binary_polygon_files()) {
    SCOPED_TRACE(file.substr(0, file.find("end_header")));
    const Mesh mesh = folder.mesh("in.ply", file);
    EXPECT_EQ(mesh.faces.offsets(), (std::vector<Index>{0, 3, 7, 9}));
    EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, 1, 2, 0, 1, 2, 3, 1, 3}));
    EXPECT_EQ(mesh.find_attribute(Domain::face, "before")->values, (std::vector<double>{100, 100, 300}));
    EXPECT_EQ(mesh.find_attribute(Domain::face, "behind")->values, (std::vector<double>{0.75, 1, 0.5}));
    EXPECT_EQ(mesh.positions(3, 2), 11);
    EXPECT_EQ(folder.written(mesh, "out.ply"), file);
  }
}

TEST(Ply, BinaryPolygonsCutOffAnywhereAreRefused) {
  const TemporaryFolder folder;
  for (const std::string& file : binary_polygon_files()) {
    for (std::size_t size = file.find("end_header"); size < file.size(); ++size) {
      const auto path = folder.file("cut.ply", std::string_view(file).substr(0, size));
      EXPECT_THROW(read_mesh(path), Error) << "cut after " << size << " bytes";
    }
  }
  std::string huge = binary_polygon_files()[1];
  huge[huge.size() - 5] = '\xFF';  // the highest byte of the last index
  const auto path = folder.file("huge.ply", huge);
  expect_error([&] { read_mesh(path); }, "io.index_too_large", {"face 2", "byte"});
}

TEST(Ply, ManyRowsAreReadTheSameByAnyNumberOfThreads) {
  const TemporaryFolder folder;
  const Mesh sample = make_sample("bumpy_plane", 150);  // several blocks of rows
  write_mesh(sample, folder / "many.ply");
  for (const int threads : {1, 2}) {
    const Mesh mesh = read_mesh(folder / "many.ply", {.threads = threads});
    EXPECT_TRUE(mesh.positions == sample.positions);
    EXPECT_TRUE(mesh.faces == sample.faces);
  }
}

struct DecimalComma : std::numpunct<char> {
  char do_decimal_point() const override { return ','; }
  char do_thousands_sep() const override { return '.'; }
  std::string do_grouping() const override { return "\3"; }
};

TEST(Ply, LocalesDoNotMatter) {
  const TemporaryFolder folder;
  const std::locale before = std::locale::global(std::locale(std::locale::classic(), new DecimalComma));
  std::setlocale(LC_ALL, "de_DE.UTF-8");  // has no effect where it is not installed
  Mesh mesh = folder.mesh("in.ply", vertices("1234.5 0.25 1e3\n"));
  EXPECT_EQ(mesh.positions(0, 0), 1234.5);
  mesh.positions(0, 0) = 4321.5;
  const std::string written = folder.written(mesh, "out.ply");
  const std::string obj = folder.written(mesh, "out.obj");
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
  EXPECT_EQ(written, vertices("4321.5 0.25 1e3\n"));
  EXPECT_EQ(obj, "v 4321.5 0.25 1000\n");
}

TEST(Ply, RecordsWithoutPropertiesTakeNoTime) {
  const TemporaryFolder folder;
  const std::string text =
      "ply\nformat ascii 1.0\nelement nothing 2147483647\nelement vertex 1\nproperty float x\nproperty float "
      "y\n"
      "property float z\nend_header\n1 2 3\n";
  const Mesh mesh = folder.mesh("a.ply", text);
  EXPECT_EQ(mesh.positions.row(0), Eigen::RowVector3d(1, 2, 3));
  EXPECT_EQ(folder.written(mesh, "b.ply"), text);
}

}  // namespace
}  // namespace meshgraft
