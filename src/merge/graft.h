#pragma once

#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The solve of a graft: the source with its loops on the target's.
struct Graft {
  Points positions;  ///< n×3
  DeformerSummary summary;
  EvaluationReport evaluation;
};

/// Root mean square distance of a loop's vertices from their centre.
double loop_radius(const Points& points, const std::vector<Index>& loop);

/// The vertices of a source beyond reach of its loops, ascending: by `reach`, or, where it names none, by
/// `radii` × each loop's own radius (half the way to the farthest vertex at most).
std::vector<Index> beyond_reach(const Points& source, const IndexLists& rings,
                                std::span<const std::vector<Index>> loops, const Reach& reach, double radii);

/// Deforms the source so that its loops meet their constraints. `source` is posed (the constraints are near
/// it); with the shape `similar` the vertices `far` follow one similarity per component, with a kept pose they
/// stay. Throws Error(unsolvable) where a part of the source is held too little.
Graft solve_graft(const Points& source, const Triangles& triangles,
                  std::span<const VertexConstraint> constraints, std::span<const Index> far,
                  const std::vector<Index>& component, const MergeOptions& options, const Context& context);

}  // namespace meshgraft
