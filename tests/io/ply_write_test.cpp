#include <array>
#include <cstring>
#include <filesystem>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/io/mesh_io.h>

#include "damage.h"
#include "expect_error.h"
#include "io/file.h"
#include "ply_files.h"
#include "temporary_folder.h"

namespace meshgraft::test {
namespace {

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

TEST(Ply, TellsWhereFloatsCannotHoldTheResult) {
  const TemporaryFolder folder;
  const auto notes_after_a_move = [&](const char* type, double distance) {
    Mesh mesh =
        folder.mesh("in.ply", std::string("ply\nformat ascii 1.0\nelement vertex 3\nproperty ") + type +
                                  " x\nproperty " + type + " y\nproperty " + type +
                                  " z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                  "0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
    mesh.positions.rowwise() += Eigen::RowVector3d(distance + 0.1, 0, 0);
    return write_mesh(mesh, folder / "out.ply").notes;
  };
  EXPECT_TRUE(notes_after_a_move("float", 10).empty());
  EXPECT_TRUE(notes_after_a_move("double", 1e5).empty());
  const std::vector<Note> notes = notes_after_a_move("float", 1e5);
  ASSERT_EQ(notes.size(), 1U);
  EXPECT_EQ(notes[0].id(), "io.coordinates_coarse");
  EXPECT_GT(notes[0].get<double>("error_rel"), 1e-4);
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

}  // namespace
}  // namespace meshgraft::test
