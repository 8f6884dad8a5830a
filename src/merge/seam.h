#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct SeamResult {
  Mesh mesh;                     ///< kept vertices of the target in their order, then those of the source
  IndexMap target, source;       ///< vertices, old → new
  std::vector<Index> new_faces;  ///< faces of the strip, in `mesh`
  std::vector<Index> band;       ///< vertices of `mesh` that fairing could move
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
