#include <algorithm>
#include <clocale>
#include <cmath>
#include <limits>
#include <locale>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>
#include <meshgraft/samples/samples.h>

#include "damage.h"
#include "ply_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

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

TEST(Ply, PointCloudsAndElementsWithoutPropertiesAreFine) {
  const TemporaryFolder folder;
  const std::string file =
      "ply\nformat ascii 1.0\nelement nothing 3\nelement vertex 1\nproperty float x\n"
      "property float y\nproperty float z\nend_header\n1 2 3\n";
  const Mesh mesh = folder.mesh("in.ply", file);
  EXPECT_EQ(mesh.face_count(), 0);
  EXPECT_EQ(folder.written(mesh, "out.ply"), file);
}

TEST(Ply, IndicesOutOfRangeAreReadForCheckMeshToName) {
  const TemporaryFolder folder;
  const Mesh mesh = folder.mesh(
      "in.ply",
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 -1 70\n");
  EXPECT_EQ(mesh.faces.corners(), (std::vector<Index>{0, -1, 70}));
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
  Mesh mesh = folder.mesh("in.ply", ascii_vertices("1234.5 0.25 1e3\n"));
  EXPECT_EQ(mesh.positions(0, 0), 1234.5);
  mesh.positions(0, 0) = 4321.5;
  const std::string written = folder.written(mesh, "out.ply");
  const std::string obj = folder.written(mesh, "out.obj");
  std::setlocale(LC_ALL, "C");
  std::locale::global(before);
  EXPECT_EQ(written, ascii_vertices("4321.5 0.25 1e3\n"));
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
}  // namespace meshgraft::test
