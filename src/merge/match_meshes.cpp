#include "match_meshes.h"

#include <algorithm>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "loops.h"
#include "match_by_arc_length.h"
#include "match_loops.h"
#include "merge/facts.h"
#include "mesh/winding.h"
#include "validate_options.h"

namespace meshgraft {

namespace {

/// Returns the source, turned over where it is oriented inconsistently with the target.
Mesh oriented_as_target(const Mesh& source, const Mesh& target, bool may_turn) {
  if (!windings_disagree(target, source)) return source;
  if (may_turn) return turned_over(source);
  const bool target_inward = enclosed_volume(target) < 0;
  throw Error(facts::merge::OrientationsDisagree{
      .inward = target_inward ? facts::merge::Side::target : facts::merge::Side::source,
      .outward = target_inward ? facts::merge::Side::source : facts::merge::Side::target});
}

/// Returns the orientations that the options give, and guesses those they do not. Guesses nothing where no
/// start has to be found.
ModelOrientations model_orientations(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                                     const MergeOptions& options, const Context& context = {}) {
  ModelOrientations found{options.target_orientations, options.source_orientations};
  if (options.pose != MergePose::find ||
      std::ranges::none_of(pairs, [](const MergePair& pair) { return pair.matches.empty(); }))
    return found;
  parallel_blocks(
      2,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t side = begin; side < end; ++side) {
          std::vector<OrientationGuess>& guesses = side == 0 ? found.target : found.source;
          if (guesses.empty()) guesses = guess_orientations(side == 0 ? target : source);
        }
      },
      context, 1);
  return found;
}

}  // namespace

Correspondence matched_again(const PairGeometry& geometry, std::span<const Match> given, Correspondence found) {
  const std::vector<Match> start{found.start};
  found.loop_parameter = match_by_arc_length(geometry, given.empty() ? std::span(start) : given).loop_parameter;
  return found;
}

MatchedMeshes match_meshes(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                           const MergeOptions& options, const Context& context) {
  MatchedMeshes matched{.target = target, .given_vertices = source.vertex_count()};
  Mesh oriented = oriented_as_target(source, target, options.fix_winding);
  std::vector<LoopPair> checked = checked_loops(target, oriented, pairs);
  matched.component = connected_components(oriented);
  require_held_components(matched.component, checked);
  matched.geometry = pair_geometry(target, oriented, checked, options.smooth_boundary);
  matched.correspondences =
      match_loops(matched.geometry, pairs, matched.component, options.pose == MergePose::keep,
                  model_orientations(target, source, pairs, options, context));
  matched.source = refine_source(std::move(oriented), std::move(checked), options.seam, context);
  if (matched.source.added == 0) return matched;
  matched.component = connected_components(matched.source.mesh);
  matched.geometry = pair_geometry(target, matched.source.mesh, matched.source.pairs, options.smooth_boundary);
  for (std::size_t p = 0; p < pairs.size(); ++p)
    matched.correspondences[p] =
        matched_again(matched.geometry[p], pairs[p].matches, std::move(matched.correspondences[p]));
  return matched;
}

std::vector<std::vector<StartCandidate>> find_starts(const Mesh& target, const Mesh& source_mesh,
                                                     std::span<const MergePair> pairs,
                                                     const MergeOptions& options) {
  validate_options(options, source_mesh, target);
  const Mesh source = oriented_as_target(source_mesh, target, options.fix_winding);
  const std::vector<LoopPair> checked = checked_loops(target, source, pairs);
  std::vector<std::vector<StartCandidate>> starts;
  for (Correspondence& found : match_loops(pair_geometry(target, source, checked, options.smooth_boundary),
                                           pairs, connected_components(source), options.pose == MergePose::keep,
                                           model_orientations(target, source_mesh, pairs, options)))
    starts.push_back(std::move(found.starts));
  return starts;
}

}  // namespace meshgraft
