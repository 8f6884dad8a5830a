#include "mesh/box_diagonal.h"

#include <cmath>

#include <gtest/gtest.h>

#include "shapes.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

TEST(BoxDiagonal, LeavesOutPointsThatAreNotFinite) {
  EXPECT_EQ(box_diagonal(Points(0, 3)), 0);
  EXPECT_EQ(box_diagonal(Points::Constant(3, 3, std::nan(""))), 0);
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    const double diagonal = box_diagonal(family.positions);
    EXPECT_DOUBLE_EQ(diagonal,
                     (family.positions.colwise().maxCoeff() - family.positions.colwise().minCoeff()).norm());
    Points with_more(family.size() + 2, 3);
    with_more << family.positions, Eigen::RowVector3d(std::nan(""), 1e9, 0),
        Eigen::RowVector3d(0, INFINITY, 1e9);
    EXPECT_EQ(box_diagonal(with_more), diagonal);
  }
}

TEST(BoxDiagonalOfFaces, LeavesOutIsolatedVertices) {
  for (const test::TestMesh& family : test::small_families()) {
    SCOPED_TRACE(family.name);
    Mesh mesh = make_mesh(family.positions, family.triangles);
    const double diagonal = box_diagonal_of_faces(mesh);
    EXPECT_DOUBLE_EQ(diagonal, family.box_diagonal());
    shapes::add_vertex(mesh, {3e9, 4e9, 0});
    EXPECT_EQ(box_diagonal_of_faces(mesh), diagonal);
    EXPECT_GT(box_diagonal(mesh.positions), diagonal);
  }
}

}  // namespace
}  // namespace meshgraft
