#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The part of a mesh that can influence a set of vertices, renumbered in ascending order, centred and scaled
/// to about unit size. The rest of the mesh is never read.
struct Patch {
  std::vector<Index> vertices;  ///< global index of each local vertex, ascending
  Points points;                ///< (p − centre) / scale
  Triangles triangles;          ///< local indices; consistently oriented where possible
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  double scale = 1;         ///< a power of two, so that scaling is exact
  bool reoriented = false;  ///< the orientation of some triangles was reversed

  Index size() const { return static_cast<Index>(vertices.size()); }
  /// Returns the local index of a global vertex, or -1.
  Index local(Index global) const;
};

/// Returns the patch of all vertices within `rings` + 1 edges of a flagged vertex. It contains all faces
/// around each vertex within `rings` edges. Throws Error(input) naming the first vertex of the patch whose
/// position is not finite.
Patch make_patch(const Points& points, const Triangles& triangles, const IndexLists& vertex_triangles,
                 std::span<const std::uint8_t> flagged, int rings, const Context& context = {});

}  // namespace meshgraft
