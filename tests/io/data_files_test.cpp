#include <algorithm>
#include <filesystem>
#include <vector>

#include <gtest/gtest.h>

#include "io/file.h"
#include "support/paths.h"
#include "temporary_folder.h"

namespace meshgraft {
namespace {

std::vector<std::filesystem::path> data_files() {
  std::vector<std::filesystem::path> files;
  for (const char* part : {"models", "open", "procedural"}) {
    const std::filesystem::path folder = test::data_folder() / part;
    if (!std::filesystem::is_directory(folder)) continue;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".ply" || extension == ".obj") files.push_back(entry.path());
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(DataFiles, AreWrittenBackByteForByte) {
  const auto files = data_files();
  if (files.empty()) GTEST_SKIP() << "no models in " << test::data_folder();
  const test::TemporaryFolder folder;
  for (const auto& path : files) {
    SCOPED_TRACE(path.filename().string());
    const Mesh mesh = read_mesh(path);
    EXPECT_GT(mesh.vertex_count(), 0);
    EXPECT_GT(mesh.face_count(), 0);
    const std::string name = "out" + path.extension().string();
    EXPECT_TRUE(folder.written(mesh, name.c_str()) == read_file(path));
  }
}

TEST(DataFiles, AMovedVertexChangesItsOwnBytesOnly) {
  const auto files = data_files();
  if (files.empty()) GTEST_SKIP() << "no models in " << test::data_folder();
  const test::TemporaryFolder folder;
  for (const auto& path : files) {
    SCOPED_TRACE(path.filename().string());
    const Mesh before = read_mesh(path);
    Mesh mesh = before;
    const Index moved = mesh.vertex_count() / 2;
    mesh.positions.row(moved) += Eigen::RowVector3d(0.25, -0.5, 0.125);
    const std::string name = "out" + path.extension().string();
    write_mesh(mesh, folder.path() / name);
    const Mesh after = read_mesh(folder.path() / name);
    ASSERT_EQ(after.vertex_count(), before.vertex_count());
    EXPECT_TRUE(after.faces == before.faces);
    for (Index v = 0; v < before.vertex_count(); ++v) {
      if (v == moved) continue;
      ASSERT_EQ(after.positions.row(v), before.positions.row(v)) << "vertex " << v;
    }
    const double scale = mesh.positions.row(moved).cwiseAbs().maxCoeff();
    EXPECT_LE((after.positions.row(moved) - mesh.positions.row(moved)).cwiseAbs().maxCoeff(), 1e-7 * scale);
  }
}

TEST(DataFiles, KeepShapeAndFacesWhenTheyChangeFormat) {
  const auto files = data_files();
  if (files.empty()) GTEST_SKIP() << "no models in " << test::data_folder();
  const test::TemporaryFolder folder;
  for (const auto& path : files) {
    SCOPED_TRACE(path.filename().string());
    const Mesh mesh = read_mesh(path);
    const char* name = path.extension() == ".ply" ? "out.obj" : "out.ply";
    write_mesh(mesh, folder / name);
    const Mesh after = read_mesh(folder / name);
    EXPECT_TRUE(after.positions == mesh.positions);
    EXPECT_TRUE(after.faces == mesh.faces);
  }
}

}  // namespace
}  // namespace meshgraft
