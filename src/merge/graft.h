#pragma once

#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The result of a graft's solve: the source with its loops on the target's loops.
struct Graft {
  Points positions;  ///< n×3
  DeformerSummary summary;
  EvaluationReport evaluation;
};

/// Returns the root mean square distance of a loop's vertices from their centre.
double loop_radius(const Points& points, const std::vector<Index>& loop);

/// Returns the vertices of a source beyond the influence radius of its loops, ascending. The radius is `reach`,
/// or, where it is not set, `radii` × each loop's own radius (at most half the distance to the farthest
/// vertex).
std::vector<Index> beyond_influence_radius(const Points& source, const IndexLists& rings,
                                           std::span<const std::vector<Index>> loops, const Reach& reach,
                                           double radii);

/// Deforms the source so that its loops meet their constraints. `source` is already posed near the
/// constraints. With the shape `similar`, the vertices `far` follow one similarity per component; with a kept
/// pose they stay. Throws Error(unsolvable) where a part of the source has too few constraints.
Graft solve_graft(const Points& source, const Triangles& triangles,
                  std::span<const VertexConstraint> constraints, std::span<const Index> far,
                  const std::vector<Index>& component, const MergeOptions& options, const Context& context);

}  // namespace meshgraft
