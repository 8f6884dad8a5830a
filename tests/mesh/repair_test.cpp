#include <meshgraft/mesh/repair.h>

#include <algorithm>
#include <cmath>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/mesh/triage.h>

#include "mesh/shapes.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

Mesh mesh_of(const test::TestMesh& family) { return make_mesh(family.positions, family.triangles); }

bool same_bits(const Mesh& a, const Mesh& b) {
  return a.faces == b.faces && a.positions.rows() == b.positions.rows() && a.positions == b.positions;
}

// What a repair with all its steps leaves of findings.
std::string findings_left(const Mesh& mesh) {
  std::string names;
  for (const Finding& finding : triage(mesh).findings)
    if (finding.name != "polygon") names += finding.name + " (" + finding.description + ") ";
  return names;
}

void expect_sound_maps(const Mesh& given, const RepairResult& result) {
  ASSERT_EQ(result.vertex.new_index.size(), static_cast<std::size_t>(given.vertex_count()));
  ASSERT_EQ(result.face.new_index.size(), static_cast<std::size_t>(given.face_count()));
  ASSERT_EQ(result.vertex_origin.size(), static_cast<std::size_t>(result.mesh.vertex_count()));
  ASSERT_EQ(result.face_origin.size(), static_cast<std::size_t>(result.mesh.face_count()));
  for (Index v = 0; v < result.mesh.vertex_count(); ++v) {
    const Index old = result.vertex_origin[v];
    if (old < 0) continue;
    ASSERT_LT(old, given.vertex_count());
    EXPECT_EQ(result.mesh.positions.row(v), given.positions.row(old));
  }
  for (const Index v : result.vertex.new_index) EXPECT_LT(v, result.mesh.vertex_count());
  for (std::size_t f = 0; f < result.face.new_index.size(); ++f)
    if (const Index now = result.face.new_index[f]; now >= 0) {
      EXPECT_EQ(result.face_origin[now], static_cast<Index>(f));
    }
}

TEST(Repair, LeavesCleanMeshesAsTheyAre) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const Mesh mesh = mesh_of(family);
    const RepairResult result = repair(mesh, {.remove_isolated = false});
    for (const RepairChange& change : result.changes)
      ADD_FAILURE() << change.name << ": " << change.description;
    EXPECT_TRUE(same_bits(result.mesh, mesh));
    expect_sound_maps(mesh, result);
  }
}

TEST(Repair, MendsEachDefectOfEachFamily) {
  for (const test::TestMesh& family : test::mesh_families()) {
    for (const std::string& kind : test::defect_kinds()) {
      SCOPED_TRACE(family.name + " " + kind);
      const test::Defective defective = test::inject(mesh_of(family), kind);
      const RepairResult result = repair(defective.mesh);
      EXPECT_EQ(findings_left(result.mesh), "");
      EXPECT_TRUE(result.changed() || defective.count == 0);
      expect_sound_maps(defective.mesh, result);
      const RepairResult again = repair(result.mesh);
      EXPECT_FALSE(again.changed()) << again.changes.front().name;
      EXPECT_TRUE(same_bits(again.mesh, result.mesh));
    }
  }
}

TEST(Repair, MakesTwentyDirtyScansDeformable) {
  int working = 0;
  for (const test::DirtyScan& scan : test::dirty_scans()) {
    SCOPED_TRACE(scan.name);
    const RepairResult result = repair(scan.mesh);
    EXPECT_EQ(findings_left(result.mesh), "");
    expect_sound_maps(scan.mesh, result);
    EXPECT_FALSE(repair(result.mesh).changed());
    const test::Trial trial = test::try_deform(result.mesh);
    EXPECT_TRUE(trial.works) << trial.reason;
    working += trial.works;
  }
  EXPECT_GE(working, 18);
}

}  // namespace
}  // namespace meshgraft
