#include "mesh/cut/cut_snap.h"

#include <gtest/gtest.h>

#include "mesh/area_vector.h"
#include "mesh/traced_faces.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(Crossing, IsWhereALinearFunctionIsZero) {
  for (const double a : {1e-200, 1e-3, 1.0, 7.0}) {
    for (const double b : {-1e-200, -0.3, -1.0, -1e5}) {
      EXPECT_TRUE(opposite(a, b) && opposite(b, a));
      EXPECT_NEAR(crossing(a, b) + crossing(b, a), 1, 1e-15);
      EXPECT_NEAR((1 - crossing(a, b)) * a + crossing(a, b) * b, 0, 1e-15 * std::max(a, -b));
    }
    for (const double same : {0.0, a}) EXPECT_FALSE(opposite(a, same));
  }
}

// Cuts families by a plane through their middle.
struct PlaneValues {
  Faces faces;
  Points positions;
  std::vector<EdgePoint> origin;
  std::vector<double> values;

  explicit PlaneValues(const test::TestMesh& family)
      : faces(make_mesh(family.positions, family.triangles).faces), positions(family.positions) {
    const Eigen::RowVector3d normal = Eigen::RowVector3d(1, 0.6, 0.3).normalized();
    const double middle = (positions.row(family.triangles(0, 0)) + positions.colwise().mean()).dot(normal) / 2;
    for (Index v = 0; v < family.size(); ++v) {
      origin.push_back(same(v));
      values.push_back(positions.row(v).dot(normal) - middle);
    }
  }
};

TEST(SnapToCut, MovesVerticesAlongTheirEdgesOntoTheCut) {
  constexpr double snap = 0.3;
  Index moved = 0;
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    const PlaneValues before(family);
    PlaneValues after = before;
    snap_to_cut(after.faces, snap, after.positions, after.origin, after.values);
    for (Index v = 0; v < family.size(); ++v) {
      const EdgePoint& from = after.origin[v];
      EXPECT_EQ(from.from, v);
      if (from.t == 0) {
        EXPECT_EQ(after.positions.row(v), before.positions.row(v));
        EXPECT_EQ(after.values[v], before.values[v]);
        continue;
      }
      ++moved;
      EXPECT_LT(from.t, snap);
      EXPECT_EQ(after.values[v], 0);
      EXPECT_NEAR(from.t, crossing(before.values[v], before.values[from.to]), 1e-12);
      EXPECT_LE((after.positions.row(v) - before.positions.row(v)).norm(),
                snap * (before.positions.row(from.to) - before.positions.row(v)).norm() * (1 + 1e-6));
    }
  }
  EXPECT_GT(moved, 20);
}

TEST(SnapToCut, TurnsNoFaceOver) {
  for (const test::TestMesh& family : test::mesh_families()) {
    SCOPED_TRACE(family.name);
    PlaneValues cut(family);
    snap_to_cut(cut.faces, 0.5, cut.positions, cut.origin, cut.values);
    for (Index f = 0; f < cut.faces.size(); ++f) {
      EXPECT_GT(area_vector(cut.faces[f], cut.positions).dot(area_vector(cut.faces[f], family.positions)), 0);
      EXPECT_FALSE(std::ranges::all_of(cut.faces[f], [&](Index v) { return cut.values[v] == 0; }));
    }
  }
}

TEST(SnapToCut, OfZeroMovesNothing) {
  for (const test::TestMesh& family : test::small_families()) {
    PlaneValues cut(family);
    snap_to_cut(cut.faces, 0, cut.positions, cut.origin, cut.values);
    EXPECT_EQ(cut.positions, family.positions);
  }
}

}  // namespace
}  // namespace meshgraft
