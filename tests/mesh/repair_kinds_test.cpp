#include "mesh/repair/repair_kinds.h"

#include <array>

#include <gtest/gtest.h>

#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

Mesh clean_of(const test::TestMesh& family) { return make_mesh(family.positions, family.triangles); }

// Kinds that a repair may leave behind: vertices that lost their faces, and copies of vertices that it took
// apart.
bool may_remain(FindingKind kind) {
  return kind == FindingKind::isolated_vertex || kind == FindingKind::duplicate_vertex;
}

TEST(RepairKinds, RemoveEachKindByItself) {
  for (const test::TestMesh& family : test::small_families())
    for (const FindingKind kind : test::defect_kinds()) {
      SCOPED_TRACE(family.name + ", " + std::string(name_of(kind)));
      ASSERT_TRUE(is_repairable(kind));
      const test::Defective defective = test::inject(clean_of(family), kind);
      if (defective.count == 0) continue;
      const RepairResult result = repair(defective.mesh, repair_for(std::array{kind}));
      EXPECT_TRUE(result.changed());
      for (const Finding& finding : check_mesh(result.mesh).findings)
        EXPECT_TRUE(finding.kind != kind && may_remain(finding.kind)) << finding.description();
    }
}

TEST(RepairKinds, LeaveOtherKindsAsTheyAre) {
  const Mesh clean = clean_of(test::bumpy_sphere(2));
  const Mesh defective = test::with_isolated(test::with_turned_patches(clean, 1, 1, 3), 4, 5);
  const RepairResult turned = repair(defective, repair_for(std::array{FindingKind::inconsistent_winding}));
  EXPECT_EQ(turned.mesh.vertex_count(), defective.vertex_count());
  const Diagnostics left = check_mesh(turned.mesh);
  EXPECT_FALSE(left.find(FindingKind::inconsistent_winding));
  ASSERT_TRUE(left.find(FindingKind::isolated_vertex));
  EXPECT_EQ(left.find(FindingKind::isolated_vertex)->count, 4);
  const RepairResult both = repair(
      defective, repair_for(std::array{FindingKind::inconsistent_winding, FindingKind::isolated_vertex}));
  EXPECT_TRUE(check_mesh(both.mesh).clean());
}

TEST(RepairKinds, OfNothingChangeNothing) {
  const Mesh defective = test::with_isolated(clean_of(test::bumpy_sphere(2)), 4, 5);
  EXPECT_FALSE(repair(defective, repair_for({})).changed());
  EXPECT_FALSE(is_repairable(FindingKind::coordinate_too_large));
  EXPECT_FALSE(is_repairable(FindingKind::polygon));
}

}  // namespace
}  // namespace meshgraft
