#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "mesh/edge_table.h"
#include "mesh/interpolate_attribute.h"

namespace meshgraft {

/// Computes shortest paths between vertices of a triangle surface, ignoring unusable faces.
///
/// A strip of triangles from one vertex to the other is unfolded into the plane. There the funnel algorithm
/// finds the shortest path within it. At a turn the strip is rerouted around the other side of the vertex if
/// that shortens the path, until no turn can be removed (Xin and Wang 2007, "Efficiently determining a
/// locally exact shortest path on polyhedral surfaces"). The result is a geodesic: no small change makes it
/// shorter.
class SurfacePaths {
 public:
  /// Keeps references to the arguments.
  SurfacePaths(const Points& positions, const Faces& triangles, const EdgeTable& table);

  /// Returns the points between two vertices, in order: on edges, with 0 < t < 1 and from < to, or at vertices
  /// (from = to). Neighbours in the list lie in one triangle. Empty if the vertices share an edge. Throws
  /// Error(input) with the id mesh.no_path if there is none.
  std::vector<EdgePoint> between(Index from, Index to, const Context& context = {}) const;

 private:
  using Strip = std::vector<Index>;  // half-edges that the strip crosses
  struct Turn;
  struct Path;

  Index vertex(Index corner) const { return triangles_.corners()[corner]; }
  Index twin(Index half_edge) const;
  bool face_has(Index half_edge, Index vertex) const;
  Strip first_strip(Index from, Index to, const Context& context) const;
  void remove_detours(Strip& strip, Index from, Index to) const;
  Strip around_other_side(const Strip& strip, const Turn& turn) const;
  Path shortest_within(const Strip& strip, Index from, Index to) const;

  const Points& positions_;
  const Faces& triangles_;
  const EdgeTable& table_;
  std::vector<Index> face_;       // per corner: its face
  std::vector<Index> corner_at_;  // per vertex: its corners, chained through `next_at_`
  std::vector<Index> next_at_;
};

}  // namespace meshgraft
