#pragma once

#include <vector>

#include <span>

#include <meshgraft/mesh/topology.h>

#include "drawn_cut.h"

namespace meshgraft {

/// Whether one lies above and the other below.
inline bool opposite(double value_a, double value_b) {
  return (value_a > 0 && value_b < 0) || (value_a < 0 && value_b > 0);
}

/// Where an edge between opposite vertices is cut: the fraction of the way from a to b.
double crossing(double value_a, double value_b);

/// Whether the faces around a vertex neither turn over nor become slivers if it moves to `target`.
class FacesAround {
 public:
  FacesAround(const Faces& faces, Index vertex_count);

  bool keep_shape(Index vertex, const Eigen::RowVector3d& target, const Points& positions) const;

  std::span<const Index> corners(Index vertex) const { return corners_at_[vertex]; }
  Index face(Index corner) const { return face_[corner]; }

 private:
  struct FaceShape;
  FaceShape shape(Index face, Index moved, const Eigen::RowVector3d& target, const Points& positions) const;

  const Faces& faces_;
  std::vector<Index> face_;  // per corner
  IndexLists corners_at_;    // per vertex
};

/// Moves vertices onto the place where one of their edges is cut, if it lies within `snap` of the edge's
/// length, the nearest first; their value becomes 0. A vertex stays where a face around would turn over or
/// become a sliver, where the cut would touch itself, and a boundary vertex moves along its boundary only.
/// `positions`, `origin` and `values` are updated.
void snap_to_cut(const Faces& faces, double snap, Points& positions, std::vector<EdgePoint>& origin,
                 std::vector<double>& values);

}  // namespace meshgraft
