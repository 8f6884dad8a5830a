// Repairs the meshes of $MESHGRAFT_DATA and $MESHGRAFT_SCANS, and compares what the report says with the
// result.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>

#include "io/file.h"
#include "mesh/area_vector.h"
#include "support/defects.h"
#include "support/mesh_files.h"
#include "support/paths.h"
#include "support/surface_losses.h"

namespace meshgraft {
namespace {

constexpr Index most_vertices = 50000;

struct DataMesh {
  std::filesystem::path path;
  Mesh mesh;
  RepairResult result;
};

std::vector<DataMesh> read_meshes() {
  std::vector<std::filesystem::path> files = test::mesh_files(test::data_folder());
  if (const char* folder = std::getenv("MESHGRAFT_SCANS")) {
    const auto scans = test::mesh_files(folder);
    files.insert(files.end(), scans.begin(), scans.end());
  }
  std::vector<DataMesh> meshes;
  for (const std::filesystem::path& path : files) {
    try {
      Mesh mesh = read_mesh(path);
      if (mesh.face_count() == 0 || mesh.vertex_count() > most_vertices) continue;
      RepairResult result = repair(mesh);
      meshes.push_back({path, std::move(mesh), std::move(result)});
    } catch (const Error&) {  // a file that is no mesh
    }
  }
  return meshes;
}

class RepairData : public testing::Test {
 protected:
  void SetUp() override {
    if (meshes().empty()) GTEST_SKIP() << "no meshes; set MESHGRAFT_DATA or MESHGRAFT_SCANS";
  }
  static const std::vector<DataMesh>& meshes() {
    static const std::vector<DataMesh> all = read_meshes();
    return all;
  }
};

std::set<Index> indices_of(const RepairResult& result, std::initializer_list<RepairChangeKind> kinds) {
  std::set<Index> indices;
  for (const RepairChangeKind kind : kinds)
    if (const RepairChange* change = result.find(kind))
      indices.insert(change->indices.begin(), change->indices.end());
  return indices;
}

std::set<Index> removed_faces(const RepairResult& result) {
  using enum RepairChangeKind;
  return indices_of(result, {removed_out_of_range_face, removed_non_finite_face, mended_degenerate_face,
                             removed_duplicate_face, removed_zero_area_face, removed_duplicate_shell,
                             removed_non_manifold_face, removed_debris});
}

Mesh largest_component(const Mesh& mesh) {
  Index count = 0;
  const std::vector<Index> component = connected_components(mesh, &count);
  std::vector<Index> faces(count, 0);
  for (Index f = 0; f < mesh.face_count(); ++f) ++faces[component[mesh.faces[f][0]]];
  const auto largest = static_cast<Index>(std::ranges::max_element(faces) - faces.begin());
  Mesh part;
  part.positions = mesh.positions;
  for (Index f = 0; f < mesh.face_count(); ++f)
    if (component[mesh.faces[f][0]] == largest) part.faces.push_back(mesh.faces[f]);
  return repair(part, {.hole_edges = 0}).mesh;  // without the isolated vertices
}

TEST_F(RepairData, LeavesNoDefect) {
  for (const auto& [path, mesh, result] : meshes()) {
    SCOPED_TRACE(path.string());
    const bool one_sided = std::ranges::any_of(
        result.notes, [](const Note& note) { return note.id() == "mesh.one_sided_surface"; });
    for (const Finding& finding : check_mesh(result.mesh).findings)
      EXPECT_TRUE(finding.kind == FindingKind::polygon ||
                  (one_sided && finding.kind == FindingKind::inconsistent_winding))
          << finding.description();
    EXPECT_TRUE(summarise_topology(result.mesh).manifold);
  }
}

// What was in pieces or could not be moved can be edited afterwards.
TEST_F(RepairData, LeavesASurfaceThatDeforms) {
  constexpr Index least_faces = 100;
  for (const auto& [path, mesh, result] : meshes()) {
    if (!result.changed() || result.mesh.face_count() < least_faces) continue;
    const test::Trial trial = test::try_deform(largest_component(result.mesh));
    EXPECT_TRUE(trial.works) << path << ": " << trial.reason;
  }
}

TEST_F(RepairData, ChangesNothingTheSecondTime) {
  const auto folder = std::filesystem::temp_directory_path() / "meshgraft_repair_data";
  std::filesystem::create_directories(folder);
  for (const auto& [path, mesh, result] : meshes()) {
    SCOPED_TRACE(path.string());
    EXPECT_FALSE(repair(result.mesh).changed());
    const auto first = folder / ("first" + path.extension().string()),
               second = folder / ("second" + path.extension().string());
    write_mesh(result.mesh, first);
    write_mesh(repair(read_mesh(first)).mesh, second);
    EXPECT_TRUE(read_file(first) == read_file(second));
    EXPECT_TRUE(result.changed() || read_file(first) == read_file(path));
  }
  std::filesystem::remove_all(folder);
}

TEST_F(RepairData, MovesOnlyWhatItWelds) {
  for (const auto& [path, mesh, result] : meshes()) {
    SCOPED_TRACE(path.string());
    std::set<Index> united = indices_of(result, {RepairChangeKind::welded_vertex});
    for (const Index f : indices_of(result, {RepairChangeKind::removed_zero_area_face}))
      united.insert(mesh.faces[f].begin(), mesh.faces[f].end());
    for (Index v = 0; v < mesh.vertex_count(); ++v) {
      const Index now = result.vertex.new_index[v];
      if (now < 0 || united.contains(v)) continue;
      EXPECT_EQ(result.mesh.positions.row(now), mesh.positions.row(v)) << "vertex " << v;
    }
    for (Index v = 0; v < result.mesh.vertex_count(); ++v) {
      const Index origin = result.vertex_origin[v];
      EXPECT_TRUE(origin < 0 || result.mesh.positions.row(v) == mesh.positions.row(origin)) << "vertex " << v;
    }
  }
}

TEST_F(RepairData, LosesNothingButWhatItReports) {
  for (const auto& [path, mesh, result] : meshes()) {
    SCOPED_TRACE(path.string());
    const std::set<Index> removed = removed_faces(result);
    std::set<Index> kept_vertices;
    double kept_area = 0, area = 0;
    for (Index f = 0; f < mesh.face_count(); ++f) {
      EXPECT_TRUE(result.face.new_index[f] >= 0 || removed.contains(f)) << "face " << f;
      if (removed.contains(f)) continue;
      kept_area += area_vector(mesh.faces[f], mesh.positions).norm();
      kept_vertices.insert(mesh.faces[f].begin(), mesh.faces[f].end());
    }
    for (const Index v : kept_vertices) EXPECT_GE(result.vertex.new_index[v], 0) << "vertex " << v;
    for (Index f = 0; f < result.mesh.face_count(); ++f)
      if (result.face_origin[f] >= 0) area += area_vector(result.mesh.faces[f], result.mesh.positions).norm();
    EXPECT_NEAR(area, kept_area, 1e-6 * kept_area);
    // By positions alone, without the report's maps.
    if (result.find(RepairChangeKind::split_t_junction)) continue;
    EXPECT_LE(test::surface_losses(mesh, result.mesh).faces, static_cast<Index>(removed.size()));
  }
}

}  // namespace
}  // namespace meshgraft
