#pragma once

#include <memory>
#include <optional>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A k-d tree of some vertices of a mesh, for searches by position.
class VertexTree {
 public:
  /// Keeps a reference to `positions`, which must be finite at `vertices`.
  VertexTree(const Points& positions, std::vector<Index> vertices);
  ~VertexTree();

  struct Found {
    Index vertex = -1;
    double distance = 0;
  };
  /// Returns the nearest vertex, the first in the list among several, or nothing if the tree is empty.
  std::optional<Found> nearest(const Eigen::RowVector3d& point) const;

  /// Returns the vertices at most `radius` away, ascending.
  std::vector<Index> within(const Eigen::RowVector3d& point, double radius) const;

  /// Returns the vertices, ascending, at most `radius` from the segment from `a` to `b`, and a few slightly
  /// farther ones. Few vertices are returned per edge even around the hub of a fan of edges.
  std::vector<Index> near_segment(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b,
                                  double radius) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace meshgraft
