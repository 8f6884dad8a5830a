#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct MergeResult {
  Mesh mesh;
  IndexMap target, source;       ///< vertices of the inputs → `mesh`, or -1 where one was removed
  Points grafted;                ///< the source's positions after the solve, before the seam (n×3)
  std::vector<Index> new_faces;  ///< faces of the seams
  std::vector<Index> band;       ///< vertices of `mesh` around the seams that fairing could move
  MergeReport report;
};

/// Grafts `source` onto `target` across pairs of boundary loops (Fu & Tai 2005, section 5). The target is not
/// moved; outside the bands around the seams it keeps its coordinates bit for bit.
///
/// Throws Error(input), naming the pair and the remedy, in these cases:
/// - a loop is not a simple boundary loop;
/// - loops meet;
/// - a connected component of the source has no loop (merge.component_without_pair);
/// - correspondences cross (merge.matches_cross) or are ambiguous (merge.open_start, see `open_starts`);
/// - the orientations disagree (merge.orientations_disagree).
/// Throws Error(unsolvable) and Error(cancelled).
MergeResult merge_meshes(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                         const MergeOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
