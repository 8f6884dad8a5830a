#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

#include "graft.h"

namespace meshgraft {

/// A source ready for the solve.
struct PosedSource {
  const Points& rest;   ///< n×3, as given and refined
  const Points& posed;  ///< n×3, near the constraints
  const Triangles& triangles;
  const std::vector<Index>& component;  ///< per vertex
  std::span<const LoopPair> pairs;
};

/// The graft that the search of an influence radius found.
struct FoundGraft {
  Graft graft;
  ShapeReport shape;
  double assemble_seconds = 0, factorise_seconds = 0;  ///< of all solves of the search
  int doublings = 0;                                   ///< of the first radius
};

/// Solves within the requested influence radius. Where none is requested and the pose is to be found, the
/// first radius is each loop's own, doubled `fewest_doublings` times or as often as that is possible. It is
/// doubled further as long as the source is squeezed within it and doubling helps. Throws Error(input) where
/// all fixed vertices are on loops, and what `solve_graft` throws.
FoundGraft graft_within_radius(const PosedSource& source, std::span<const VertexConstraint> constraints,
                               const MergeOptions& options, int fewest_doublings, const Context& context);

}  // namespace meshgraft
