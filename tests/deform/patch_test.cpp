#include "deform/setup/patch.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/shapes.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

/// Returns flags of the head of a family, around which patches are made.
Flags flagged_head(const test::Scene& scene) {
  Flags flagged(static_cast<std::size_t>(scene.mesh.size()), 0);
  for (const Index v : scene.head) flagged[v] = 1;
  return flagged;
}

Patch patch_around(const test::TestMesh& mesh, const Flags& flagged, int rings, const Context& context = {}) {
  return make_patch(mesh.positions, mesh.triangles, vertex_triangles(mesh.size(), mesh.triangles), flagged,
                    rings, context);
}

TEST(Patch, HoldsTheVerticesWithinItsRingsAscending) {
  for (const test::TestMesh& mesh : test::mesh_families())
    for (const int rings : {0, 1, 3}) {
      const test::Scene scene = test::make_scene(mesh);
      const Patch patch = patch_around(mesh, flagged_head(scene), rings);
      EXPECT_EQ(patch.vertices, grow_rings(scene.head, rings + 1, vertex_rings(mesh.size(), mesh.triangles)))
          << mesh.name;
      for (Index v = 0; v < mesh.size(); ++v) {
        const Index local = patch.local(v);
        const bool inside = std::find(patch.vertices.begin(), patch.vertices.end(), v) != patch.vertices.end();
        EXPECT_EQ(local >= 0, inside);
        if (inside) {
          EXPECT_EQ(patch.vertices[local], v);
        }
      }
    }
}

TEST(Patch, HoldsAllFacesAroundItsInnerVertices) {
  for (const test::TestMesh& mesh : test::mesh_families())
    for (const int rings : {0, 1, 3}) {
      SCOPED_TRACE(mesh.name);
      const test::Scene scene = test::make_scene(mesh);
      const Patch patch = patch_around(mesh, flagged_head(scene), rings);
      const auto inner = grow_rings(scene.head, rings, vertex_rings(mesh.size(), mesh.triangles));
      std::vector<std::array<Index, 3>> found;
      for (const auto& t : patch.triangles.rowwise())
        found.push_back({patch.vertices[t[0]], patch.vertices[t[1]], patch.vertices[t[2]]});
      for (const auto& t : mesh.triangles.rowwise()) {
        if (std::none_of(t.begin(), t.end(),
                         [&](Index v) { return std::binary_search(inner.begin(), inner.end(), v); }))
          continue;
        EXPECT_EQ(std::count(found.begin(), found.end(), std::array{t[0], t[1], t[2]}), 1);
      }
    }
}

TEST(Patch, IsCentredAndScaledByAPowerOfTwo) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Patch patch = patch_around(mesh, flagged_head(test::make_scene(mesh)), 2);
    int exponent = 0;
    EXPECT_EQ(std::frexp(patch.scale, &exponent), 0.5);
    const Eigen::RowVector3d size = patch.points.colwise().maxCoeff() - patch.points.colwise().minCoeff();
    EXPECT_GT(size.norm(), 0.7);
    EXPECT_LT(size.norm(), 1.42);
    EXPECT_LT((patch.points.colwise().maxCoeff() + patch.points.colwise().minCoeff()).norm(), 1e-6);
    for (Index i = 0; i < patch.size(); ++i) {
      const Eigen::RowVector3d back = patch.scale * patch.points.row(i) + patch.centre;
      EXPECT_LT((back - mesh.positions.row(patch.vertices[i])).norm(),
                1e-15 * (patch.scale + patch.centre.norm()));
    }
  }
}

TEST(Patch, DoesNotReadTheRestOfTheMesh) {
  for (const test::TestMesh& mesh : test::small_families()) {
    const Flags flagged = flagged_head(test::make_scene(mesh));
    const Patch patch = patch_around(mesh, flagged, 1);
    test::TestMesh damaged = mesh;
    for (Index v = 0; v < mesh.size(); ++v)
      if (patch.local(v) < 0) damaged.positions.row(v).setConstant(std::numeric_limits<double>::quiet_NaN());
    const Patch again = patch_around(damaged, flagged, 1);
    EXPECT_EQ(again.vertices, patch.vertices) << mesh.name;
    EXPECT_TRUE(test::same_bytes(again.points, patch.points)) << mesh.name;
    damaged.positions.row(patch.vertices.back()).setConstant(std::numeric_limits<double>::infinity());
    EXPECT_THROW(patch_around(damaged, flagged, 1), Error) << mesh.name;
  }
}

TEST(Patch, TurnsFacesUntilTheyAreConsistentlyOriented) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const Flags all(static_cast<std::size_t>(mesh.size()), 1);
    const Patch tidy = patch_around(mesh, all, 1);
    EXPECT_FALSE(tidy.reoriented);
    test::TestMesh mixed = mesh;
    for (Eigen::Index t = 1; t < mixed.triangles.rows(); t += 3)
      std::swap(mixed.triangles(t, 0), mixed.triangles(t, 1));
    const Patch patch = patch_around(mixed, all, 1);
    EXPECT_TRUE(patch.reoriented);
    EXPECT_TRUE(summarise_topology(make_mesh(patch.points, patch.triangles)).oriented);
  }
}

TEST(Patch, TheNumberOfThreadsDoesNotMatter) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    const Flags flagged = flagged_head(test::make_scene(mesh));
    const Patch one = patch_around(mesh, flagged, 2, shapes::with_threads(1));
    for (const int threads : {2, 3}) {
      const Patch other = patch_around(mesh, flagged, 2, shapes::with_threads(threads));
      EXPECT_EQ(one.vertices, other.vertices) << mesh.name;
      EXPECT_EQ(one.triangles, other.triangles) << mesh.name;
      EXPECT_TRUE(test::same_bytes(one.points, other.points)) << mesh.name;
    }
  }
}

TEST(Patch, AroundNothingIsEmpty) {
  const test::TestMesh mesh = test::grid(4, 4);
  const Patch patch = patch_around(mesh, Flags(static_cast<std::size_t>(mesh.size()), 0), 3);
  EXPECT_EQ(patch.size(), 0);
  EXPECT_EQ(patch.triangles.rows(), 0);
}

}  // namespace
}  // namespace meshgraft
