#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

#include "seam_patch.h"

namespace meshgraft {

/// A joined mesh, and where its vertices were in the inputs.
struct JoinedMesh {
  const Mesh& mesh;
  SeamLayout layout;
  /// n×3. A vertex that its input did not have is not finite. Target and source may lie anywhere, also within
  /// one another.
  const Points& rest;
};

/// Counts folded edges and intersections of the strips, and of the faces within three rings of them, that the
/// inputs did not have.
SeamFaults find_seam_faults(const JoinedMesh& joined, const Context& context);

}  // namespace meshgraft
