#include <algorithm>

#include <gtest/gtest.h>

#include "mesh/face_defects.h"
#include "mesh/face_keys.h"
#include "mesh/repair/repair_surface.h"
#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context uncancelled;

// Calls `body(clean mesh)` for families that are large enough to be damaged.
template <class Body>
void for_clean_meshes(const Body& body) {
  for (const test::TestMesh& family : test::small_families()) {
    if (family.triangles.rows() < 40) continue;
    SCOPED_TRACE(family.name);
    body(make_mesh(family.positions, family.triangles));
  }
}

TEST(RemoveInvalid, LeavesFacesOfFiniteVertices) {
  for_clean_meshes([](const Mesh& clean) {
    const Mesh mesh = test::with_bad_indices(test::with_non_finite(clean, 2, 1), 3, 1);
    RepairSurface untouched(clean, uncancelled), surface(mesh, uncancelled);
    EXPECT_FALSE(remove_invalid(untouched));
    EXPECT_TRUE(remove_invalid(surface));
    EXPECT_GT(surface.faces().size(), 0);
    for (Index f = 0; f < surface.faces().size(); ++f) {
      ASSERT_TRUE(in_range(surface.mesh(), f));
      for (const Index v : surface.faces()[f]) EXPECT_TRUE(surface.positions().row(v).allFinite());
    }
    EXPECT_FALSE(remove_invalid(surface));
  });
}

TEST(CleanCorners, LeavesFacesOfDistinctCorners) {
  for_clean_meshes([](const Mesh& clean) {
    Mesh mesh = clean;
    const Index a = clean.faces[0][0], b = clean.faces[0][1], c = clean.faces[0][2];
    for (const std::vector<Index>& face :
         {std::vector<Index>{a}, {a, b}, {a, a, b}, {a, b, b, c}, {a, b, a, c}})
      mesh.faces.push_back(face);
    RepairSurface untouched(clean, uncancelled), surface(mesh, uncancelled);
    EXPECT_FALSE(clean_corners(untouched));
    EXPECT_TRUE(clean_corners(surface));
    for (Index f = 0; f < surface.faces().size(); ++f) EXPECT_FALSE(is_degenerate(surface.faces()[f])) << f;
    EXPECT_GT(surface.faces().size(), clean.face_count()) << "a face with three corners left is kept";
    EXPECT_FALSE(clean_corners(surface));
  });
}

TEST(RemoveDuplicateFaces, KeepsTheFirstOfEach) {
  for_clean_meshes([](const Mesh& clean) {
    const Mesh mesh = test::with_repeated_faces(clean, 4, 1);
    RepairSurface untouched(clean, uncancelled), surface(mesh, uncancelled);
    EXPECT_FALSE(remove_duplicate_faces(untouched));
    EXPECT_TRUE(remove_duplicate_faces(surface));
    EXPECT_EQ(surface.faces(), clean.faces);
  });
}

TEST(RemoveZeroArea, LeavesFacesWithArea) {
  for_clean_meshes([](const Mesh& clean) {
    for (const Mesh& mesh : {test::with_needles(clean, 3, 1), test::with_caps(clean, 3, 1)}) {
      RepairSurface surface(mesh, uncancelled);
      ASSERT_TRUE(remove_zero_area(surface, true));
      clean_corners(surface);
      for (Index f = 0; f < surface.faces().size(); ++f)
        EXPECT_FALSE(has_no_area(surface.faces()[f], surface.positions())) << f;
    }
    RepairSurface untouched(clean, uncancelled);
    EXPECT_FALSE(remove_zero_area(untouched, true));
  });
}

}  // namespace
}  // namespace meshgraft
