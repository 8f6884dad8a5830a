#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Some vertices of a mesh, to be found by their place: a k-d tree.
class VertexTree {
 public:
  /// Refers to `positions`, which have to be finite at `vertices`.
  VertexTree(const Points& positions, std::vector<Index> vertices);
  ~VertexTree();

  struct Found {
    Index vertex = -1;
    double distance = 0;
  };
  /// The nearest; the first in the list among several. None without vertices.
  std::optional<Found> nearest(const Eigen::RowVector3d& point) const;

  /// Those at most `radius` away, ascending.
  std::vector<Index> within(const Eigen::RowVector3d& point, double radius) const;

  /// Those, ascending, that may lie on the way from `a` to `b`, at most `reach` aside of it; some of them do
  /// not. Around the hub of a fan of edges it is few of them for each.
  std::vector<Index> near_segment(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, double reach) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace meshgraft
