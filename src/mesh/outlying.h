#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Largest absolute value of a coordinate that an edit takes, so that products of six lengths stay finite.
constexpr double largest_coordinate = 1e60;

/// The vertices whose coordinates are too far out for an edit, and where the others lie. The others' centre is
/// the median of each coordinate. A vertex's distance is the largest absolute difference of its coordinates
/// from the centre. The radius is the least one within which three quarters of the vertices lie. Vertices that
/// no face uses count only for the lists.
struct OutlyingVertices {
  /// Vertices more than 1e6 radii away, each in a face with a vertex 1e6 times nearer, and in a component of
  /// which three quarters are no such vertices; and those beyond `largest_coordinate` that are more than 1e6
  /// radii away. Ascending.
  std::vector<Index> far;
  /// Other vertices beyond `largest_coordinate`, ascending. The whole mesh is too large.
  std::vector<Index> too_large;
  double centre[3] = {0, 0, 0};
  double radius = 0;

  bool empty() const { return far.empty() && too_large.empty(); }
  /// Returns the distance of a point from the centre.
  double distance(const Eigen::RowVector3d& point) const;
};

/// Finds them; non-finite vertices are in neither list. Takes linear time.
OutlyingVertices find_outlying(const Mesh& mesh, const Context& context = {});

}  // namespace meshgraft
