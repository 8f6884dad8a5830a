#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

#include "pair_geometry.h"
#include "refine_source.h"

namespace meshgraft {

/// Two meshes whose loops are matched, ready for a graft.
struct MatchedMeshes {
  const Mesh& target;
  RefinedSource source;
  std::vector<Index> component;  ///< per vertex of the source
  std::vector<PairGeometry> geometry;
  std::vector<Correspondence> correspondences;
  Index given_vertices = 0;  ///< of the source; refinement added the others
};

/// Checks the pairs' loops, matches them, and refines the source at its loops. Throws what `merge_meshes`
/// throws of orientations, loops, matches and components.
MatchedMeshes match_meshes(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                           const MergeOptions& options, const Context& context);

/// Returns the correspondence of a pair whose geometry was refined, or whose start was moved: from its start,
/// or from the matches that are given.
Correspondence matched_again(const PairGeometry& geometry, std::span<const Match> given, Correspondence found);

}  // namespace meshgraft
