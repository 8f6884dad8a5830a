#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/fact.h>
#include <meshgraft/merge/correspondence.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Methods to fill the gap between two loops with triangles.
enum class StripMethod {
  greedy,   ///< from the closest pair on, always the better one of the next two triangles (FT05 section 5)
  optimal,  ///< the strip of least total cost (dynamic programming)
};

struct SeamOptions {
  StripMethod strip = StripMethod::optimal;
  /// Bound of the ratio of target to source edge lengths. The target's ring at the seam is halved until the
  /// edges along its loop are at most this many times as long as the source's.
  double edge_ratio = 2;
  int smoothing_steps = 2;      ///< fairings of the band, each a linear solve; 0 leaves it unchanged
  int target_rings = 3;         ///< rings of the target that they may move; 0 leaves it unchanged bit for bit
  int source_rings = 3;         ///< rings of the source that they may move
  double sharp_angle_deg = 45;  ///< edges of the target sharper than this do not move
};

/// Measures of a finished seam.
struct SeamReport {
  bool manifold = false, oriented = false;
  bool closed = false;  ///< the result has no boundary
  Index euler_characteristic = 0, expected_euler_characteristic = 0;
  Index new_faces = 0;          ///< faces of the strip
  double angle_p1_deg = 0;      ///< 1st percentile of the smallest angles of the strip's triangles
  double dihedral_p99_deg = 0;  ///< 99th percentile over edges of the strip; 0° is flat
  /// The same for the neighbourhoods on both sides.
  double target_dihedral_p99_deg = 0, source_dihedral_p99_deg = 0;
  /// Largest displacement of a target vertex, × the diagonal of the result.
  double band_displacement_rel = 0;
  double edge_ratio = 1;  ///< mean edge length of the source's loops / that of the target's
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
