#include "mesh/vertex_tree.h"

#include <random>

#include <gtest/gtest.h>

#include "support/mesh_families.h"

namespace meshgraft {
namespace {

double distance_to_segment(const Eigen::RowVector3d& x, const Eigen::RowVector3d& a,
                           const Eigen::RowVector3d& b) {
  const Eigen::RowVector3d along = b - a;
  return (a + std::clamp((x - a).dot(along) / along.squaredNorm(), 0.0, 1.0) * along - x).norm();
}

// Calls `body(positions, listed vertices, tree, point, point)` for families and random pairs of points.
template <class Body>
void for_trees(const Body& body) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1, 1);
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    std::vector<Index> vertices;
    for (Index v = 0; v < mesh.size(); ++v)
      if (v % 3 != 1) vertices.push_back(v);
    const VertexTree tree(mesh.positions, vertices);
    const Eigen::RowVector3d centre = mesh.positions.colwise().mean();
    const auto point = [&]() -> Eigen::RowVector3d {
      return centre +
             mesh.box_diagonal() * Eigen::RowVector3d(uniform(random), uniform(random), uniform(random));
    };
    for (int k = 0; k < 20; ++k) body(mesh, vertices, tree, point(), point());
  }
}

TEST(VertexTree, FindsTheNearestVertex) {
  EXPECT_FALSE(VertexTree(Points(0, 3), {}).nearest({0, 0, 0}).has_value());
  for_trees([](const auto& mesh, const auto& vertices, const VertexTree& tree, const auto& point, const auto&) {
    double least = std::numeric_limits<double>::infinity();
    for (const Index v : vertices) least = std::min(least, (mesh.positions.row(v) - point).norm());
    const auto found = tree.nearest(point);
    ASSERT_TRUE(found.has_value());
    EXPECT_TRUE(std::ranges::binary_search(vertices, found->vertex));
    EXPECT_NEAR(found->distance, least, 1e-14 * mesh.box_diagonal());
  });
}

TEST(VertexTree, FindsTheVerticesWithinABall) {
  for_trees(
      [](const auto& mesh, const auto& vertices, const VertexTree& tree, const auto& point, const auto& other) {
        const double radius = (point - other).norm() / 2;
        std::vector<Index> expected;
        for (const Index v : vertices)
          if ((mesh.positions.row(v) - point).norm() <= radius) expected.push_back(v);
        EXPECT_EQ(tree.within(point, radius), expected);
      });
}

TEST(VertexTree, FindsTheVerticesNearASegment) {
  for_trees([](const auto& mesh, const auto& vertices, const VertexTree& tree, const auto& a, const auto& b) {
    const double radius = mesh.box_diagonal() / 10;
    const std::vector<Index> found = tree.near_segment(a, b, radius);
    EXPECT_TRUE(std::ranges::is_sorted(found));
    for (const Index v : vertices) {
      const double distance = distance_to_segment(mesh.positions.row(v), a, b);
      const bool is_found = std::ranges::binary_search(found, v);
      if (distance < radius * (1 - 1e-12)) {
        EXPECT_TRUE(is_found) << v;
      }
      if (distance > radius * (1 + 1e-9)) {
        EXPECT_FALSE(is_found) << v;
      }
    }
  });
}

}  // namespace
}  // namespace meshgraft
