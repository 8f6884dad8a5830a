#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/correspondence.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// How the gap between two loops is filled with triangles.
enum class StripMethod {
  greedy,   ///< from the closest pair on, always the better of the two next triangles (FT05 section 5)
  optimal,  ///< the strip of least total cost (dynamic programming)
};

struct SeamOptions {
  StripMethod strip = StripMethod::optimal;
  /// The target's ring at the seam is halved until the edges along its loop are at most this many times the
  /// source's.
  double edge_ratio = 2;
  int smoothing_steps = 2;  ///< fairings of the band, each a linear solve; 0 leaves it as it is
  int target_rings = 3;     ///< rings of the target that they may move; 0 leaves it bit-identical
  int source_rings = 3;
  double sharp_angle_deg = 45;  ///< edges of the target sharper than this keep their place
};

/// What was found of a finished seam.
struct SeamReport {
  bool manifold = false, oriented = false;
  bool closed = false;  ///< no boundary is left
  Index euler_characteristic = 0, expected_euler_characteristic = 0;
  Index new_faces = 0;          ///< of the strip
  double angle_p1_deg = 0;      ///< 1st percentile of the strip's smallest angles
  double dihedral_p99_deg = 0;  ///< over edges of the strip; 0° is flat
  double target_dihedral_p99_deg = 0, source_dihedral_p99_deg = 0;  ///< of the neighbourhoods on both sides
  double band_displacement_rel = 0;  ///< largest move of a target vertex, × the result's diagonal
  double edge_ratio = 1;             ///< mean edge length of the source's loop over the target's
};

struct SeamResult {
  Mesh mesh;                     ///< kept vertices of the target in their order, then those of the source
  IndexMap target, source;       ///< vertices, old → new
  std::vector<Index> new_faces;  ///< of the strip, in `mesh`
  std::vector<Index> band;       ///< vertices of `mesh` that smoothing could move
  SeamReport report;
  std::vector<std::string> notes;  ///< sentences for people: what of the source was renamed
};

/// Joins a source whose loops lie on the target's (FT05 section 5): removes the target's loops with their ring
/// of faces (halved first where it is much coarser than the source), fills each gap with a strip of triangles
/// that visits all vertices of both sides, and smooths the band around it. Attributes of both are kept; new
/// faces are labelled "seam" in the face attribute "group". Throws Error(input), naming the pair, where the
/// ring cannot be taken away without cutting more of the target off, or a loop is not a boundary loop.
SeamResult make_seam(const Mesh& target, const Mesh& source, std::span<const LoopPair> pairs,
                     const SeamOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
