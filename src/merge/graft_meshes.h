#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_options.h>

#include "graft_within_radius.h"
#include "match_meshes.h"
#include "seam.h"

namespace meshgraft {

/// A source that was deformed to meet the target's loops.
struct GraftedSource {
  FoundGraft found;
  std::vector<double> misfits_rel;  ///< per pair
  double seconds = 0;
};

/// A whole graft with one choice of settings.
struct MadeGraft {
  std::vector<Correspondence> correspondences;
  GraftedSource grafted;
  SeamResult seam;

  /// Number of inverted maps in the graft that had the fewest, this one or another that was tried.
  Index fewest_inverted = 0;

  Index faults() const { return grafted.found.shape.inverted + seam.report.faults.total(); }
};

/// Poses the source near the target, then deforms it so that its loops meet the target's.
GraftedSource graft_source(const MatchedMeshes& matched, std::span<const Correspondence> correspondences,
                           const MergeOptions& options, int fewest_doublings, const Context& context);

/// Joins the target and the grafted source, and counts the faults at the seam.
SeamResult join_source(const MatchedMeshes& matched, const GraftedSource& grafted, const MergeOptions& options,
                       const Context& context);

}  // namespace meshgraft
