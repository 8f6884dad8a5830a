#pragma once

#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A joined mesh, and where its vertices were in the inputs.
struct JoinedMesh {
  const Mesh& mesh;
  std::span<const Index> new_faces, band;  ///< faces of the strips; vertices that fairing could move
  /// n×3. A vertex that its input did not have is not finite. Target and source may lie anywhere, also within
  /// one another.
  const Points& rest;
  Index target_vertices = 0;  ///< those of the target come first
};

/// Counts folded edges and intersections of strips and bands that the inputs did not have.
SeamFaults find_seam_faults(const JoinedMesh& joined, const Context& context);

}  // namespace meshgraft
