#include "mesh/repair/hole_boundary.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>
#include <meshgraft/mesh/topology.h>

#include "support/defects.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

const Context boundary_context;

std::vector<test::TestMesh> closed_meshes() {
  return {test::icosphere(3), test::bumpy_sphere(4), test::torus(60, 30), test::bar(12, 30)};
}

// Every half-edge of the boundary is part of the loop around one crack, however many patches meet.
TEST(HoleBoundary, FollowsEachCrackOnBothSides) {
  for (const test::TestMesh& family : closed_meshes())
    for (const int patches : {2, 3, 5})
      for (const bool apart : {false, true}) {
        SCOPED_TRACE(family.name + ", " + std::to_string(patches) + (apart ? " patches apart" : " patches"));
        const Mesh cracked =
            test::with_cracks(make_mesh(family.positions, family.triangles), patches, 0.05, apart);
        RepairSurface surface(cracked, boundary_context);
        stitch(surface, {});
        split_non_manifold(surface);
        const HoleBoundary boundary(surface, {});
        Index unsound = 0;
        std::vector<Index> along, around;
        for (const auto& loop : boundary.loops(1000, unsound))
          along.insert(along.end(), loop.begin(), loop.end());
        std::size_t longest = 0;
        for (const auto& loop : boundary.touching_loops()) {
          around.insert(around.end(), loop.begin(), loop.end());
          longest = std::max(longest, loop.size());
        }
        std::sort(along.begin(), along.end());
        std::sort(around.begin(), around.end());
        EXPECT_EQ(unsound, 0);
        EXPECT_GT(around.size(), 20U);
        EXPECT_TRUE(std::includes(along.begin(), along.end(), around.begin(), around.end()));
        EXPECT_LE(longest, 24U);
      }
}

TEST(HoleBoundary, HasNoTouchingLoopsWhereNothingTouches) {
  for (const test::TestMesh& family : {test::grid(8, 8), test::tube(12, 5), test::icosphere(2)}) {
    const Mesh mesh = make_mesh(family.positions, family.triangles);
    const RepairSurface surface(mesh, boundary_context);
    EXPECT_TRUE(HoleBoundary(surface, {}).touching_loops().empty()) << family.name;
  }
}

// A mesh of patches with cracks between them becomes one closed surface. No vertex of the given mesh moves.
TEST(Repair, ClosesTheCracksBetweenPatches) {
  for (const test::TestMesh& family : closed_meshes())
    for (const int patches : {2, 3, 5})
      for (const bool apart : {false, true}) {
        SCOPED_TRACE(family.name + ", " + std::to_string(patches) + (apart ? " patches apart" : " patches"));
        const Mesh whole = make_mesh(family.positions, family.triangles);
        const Mesh cracked = test::with_cracks(whole, patches, 0.05, apart);
        const RepairResult result = repair(cracked);
        const TopologySummary before = summarise_topology(whole), after = summarise_topology(result.mesh);
        EXPECT_TRUE(after.closed && after.manifold && after.oriented);
        EXPECT_EQ(after.components, 1);
        EXPECT_EQ(after.euler_characteristic, before.euler_characteristic);
        EXPECT_FALSE(check_mesh(result.mesh).has_defects());
        EXPECT_FALSE(repair(result.mesh).changed());
        for (Index v = 0; v < cracked.vertex_count(); ++v)
          EXPECT_EQ(result.mesh.positions.row(result.vertex.new_index[v]), cracked.positions.row(v));
      }
}

// Returns two flat sheets that face the same side and have one position in common.
Mesh touching_sheets() {
  const test::TestMesh sheet = test::flat_sheet(12, 12);
  const Mesh one = make_mesh(sheet.positions, sheet.triangles);
  Mesh other = one;
  Eigen::Index low = 0, high = 0;
  other.positions.rowwise().sum().minCoeff(&low);
  other.positions.rowwise().sum().maxCoeff(&high);
  const Eigen::RowVector3d shift = one.positions.row(high) - one.positions.row(low);
  other.positions.rowwise() += shift;
  other.positions.row(low) = one.positions.row(high);
  return test::both(one, other);
}

TEST(HoleBoundary, PassesEachPositionOnce) {
  const Mesh sheets = touching_sheets();
  const RepairSurface surface(sheets, boundary_context);
  const HoleBoundary boundary(surface, {});
  const auto loops = boundary.touching_loops();
  EXPECT_EQ(loops.size(), 2U);
  for (const auto& loop : loops) {
    std::set<Index> positions;
    for (const Index c : loop) EXPECT_TRUE(positions.insert(boundary.position_of(c)).second);
  }
}

// Returns a torus of n × n tiles that touch in their corners. The middle of each side is pulled towards the
// tile's own middle, so that each pair of neighbours has a crack of four edges between them, and four cracks
// meet in a corner.
Mesh cracked_tiles(Index n) {
  Mesh mesh;
  mesh.positions = Points::Zero(6 * n * n, 3);
  const auto corner = [&](Index i, Index j) { return j % n * n + i % n; };
  const double turn = 2 * std::numbers::pi / n;
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const double radius = 2 + std::cos(turn * j);
      mesh.positions.row(corner(i, j)) << radius * std::cos(turn * i), radius * std::sin(turn * i),
          std::sin(turn * j);
    }
  for (Index j = 0; j < n; ++j)
    for (Index i = 0; i < n; ++i) {
      const Index middle = n * n + 5 * corner(i, j);
      const std::array around{corner(i, j), corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1)};
      for (const Index v : around) mesh.positions.row(middle) += 0.25 * mesh.positions.row(v);
      for (Index k = 0; k < 4; ++k) {
        const Index from = around[k], to = around[(k + 1) % 4], side = middle + 1 + k;
        mesh.positions.row(side) =
            0.45 * (mesh.positions.row(from) + mesh.positions.row(to)) + 0.1 * mesh.positions.row(middle);
        mesh.faces.push_back(std::array{from, side, middle});
        mesh.faces.push_back(std::array{side, to, middle});
      }
    }
  return mesh;
}

TEST(HoleBoundary, SeparatesTheCracksThatMeetInAVertex) {
  for (const Index n : {8, 11}) {
    const Mesh tiles = cracked_tiles(n);
    RepairSurface surface(tiles, boundary_context);
    split_non_manifold(surface);
    const auto loops = HoleBoundary(surface, {}).touching_loops();
    EXPECT_EQ(std::ssize(loops), 2 * n * n);
    for (const auto& loop : loops) EXPECT_EQ(loop.size(), 4U);
    const TopologySummary after = summarise_topology(repair(tiles, {.hole_edges = 4}).mesh);
    EXPECT_EQ(after.components, 1);
    EXPECT_EQ(after.genus, 1);
  }
}

// A patch of few faces is no debris if only cracks divide it from the rest.
TEST(Repair, KeepsASmallPatchInsideCracks) {
  const test::TestMesh sphere = test::icosphere(4);
  const Mesh whole = make_mesh(sphere.positions, sphere.triangles);
  const Index n = whole.vertex_count();
  const std::vector<Index> inside = grow_rings(std::array{Index{0}}, 2, vertex_rings(n, whole.faces));
  Mesh patch, rest;  // the patch has vertices of its own, those from n on
  rest.positions = whole.positions;
  patch.positions = whole.positions.replicate(2, 1);
  for (Index f = 0; f < whole.face_count(); ++f) {
    std::vector<Index> face(whole.faces[f].begin(), whole.faces[f].end());
    const bool is_inside =
        std::ranges::all_of(face, [&](Index v) { return std::ranges::binary_search(inside, v); });
    for (Index& v : face) v += is_inside ? n : 0;
    (is_inside ? patch : rest).faces.push_back(face);
  }
  const std::vector<Index> outline = boundary_loops(patch).front();
  for (std::size_t k = 0; k < outline.size(); k += 2)  // every second vertex is pulled in
    patch.positions.row(outline[k]) += 0.05 * (whole.positions.row(0) - whole.positions.row(outline[k] - n));
  const Mesh cracked = test::both(rest, patch);

  const RepairResult result = repair(cracked);
  EXPECT_EQ(outline.size() % 2, 0U);
  EXPECT_EQ(result.find(RepairChangeKind::removed_debris), nullptr);
  EXPECT_TRUE(std::ranges::find(result.face.new_index, -1) == result.face.new_index.end());
  const TopologySummary after = summarise_topology(result.mesh);
  EXPECT_TRUE(after.closed && after.manifold && after.oriented);
  EXPECT_EQ(after.components, 1);
}

TEST(Repair, LeavesSheetsThatTouchInAVertexApart) {
  const Mesh sheets = touching_sheets();
  EXPECT_FALSE(repair(sheets).changed());
  EXPECT_EQ(summarise_topology(repair(sheets, {.hole_edges = 200}).mesh).components, 2);
}

}  // namespace
}  // namespace meshgraft
