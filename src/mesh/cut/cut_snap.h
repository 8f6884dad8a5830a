#pragma once

#include <vector>

#include <span>

#include <meshgraft/mesh/topology.h>

#include "drawn_cut.h"

namespace meshgraft {

/// Returns whether one vertex lies above the cut and the other one below it.
inline bool opposite(double value_a, double value_b) {
  return (value_a > 0 && value_b < 0) || (value_a < 0 && value_b > 0);
}

/// Returns where the cut crosses an edge between vertices on opposite sides: the fraction of the way from a
/// to b.
double crossing(double value_a, double value_b);

/// Tests whether a vertex can move to `target` without turning over the faces around it or making them
/// slivers.
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

/// Moves vertices onto the cut. A vertex moves to a crossing of one of its edges within `snap` of the edge's
/// length, the nearest crossings first, and its value becomes 0. A vertex stays if a face around it would
/// turn over or become a sliver, or if the cut would touch itself. A boundary vertex moves only along its
/// boundary. Updates `positions`, `origin` and `values`.
void snap_to_cut(const Faces& faces, double snap, Points& positions, std::vector<EdgePoint>& origin,
                 std::vector<double>& values, const Context& context = {});

}  // namespace meshgraft
