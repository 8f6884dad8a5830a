#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/fact.h>
#include <meshgraft/merge/correspondence.h>
#include <meshgraft/merge/seam_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Methods to fill the gap between two loops with triangles.
enum class StripMethod {
  greedy,   ///< from the closest pair on, always the better one of the next two triangles (FT05 section 5)
  optimal,  ///< the strip of least total cost (dynamic programming)
};

struct SeamOptions {
  StripMethod strip = StripMethod::optimal;
  /// Bound of edge lengths of the target's loop / the source's mean edge length. The target's ring at the seam
  /// is halved until this holds.
  double edge_ratio = 2;
  int smoothing_steps = 2;      ///< fairings of the band, each a linear solve; 0 leaves it unchanged
  int target_rings = 3;         ///< rings of the target that they may move; 0 leaves it unchanged bit for bit
  int source_rings = 3;         ///< rings of the source that they may move
  double sharp_angle_deg = 45;  ///< edges of the target sharper than this do not move
};

struct SeamResult {
  Mesh mesh;                     ///< kept vertices of the target in their order, then those of the source
  IndexMap target, source;       ///< vertices, old → new
  std::vector<Index> new_faces;  ///< faces of the strip, in `mesh`
  std::vector<Index> band;       ///< vertices of `mesh` that smoothing could move
  SeamReport report;
  std::vector<Note> notes;  ///< about names of the source that were changed
};

/// Joins a source whose loops lie on the target's (FT05 section 5). It removes the target's loops with their
/// ring of faces, which is halved first where it is much coarser than the source. It fills each gap with a
/// strip of triangles that visits all vertices of both sides, and fairs the band around the strip. Attributes
/// of both meshes are kept; new faces are labelled "seam" in the face attribute "group". Throws Error(input),
/// naming the pair, where the ring cannot be removed without cutting off more of the target, or where a loop
/// is not a boundary loop.
SeamResult make_seam(const Mesh& target, const Mesh& source, std::span<const LoopPair> pairs,
                     const SeamOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
