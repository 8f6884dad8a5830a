#pragma once

#include <functional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "hole_search.h"
#include "mesh/interpolate_attribute.h"

namespace meshgraft {

/// A filled hole: the n points of its loop, then m new ones, and triangles between all of them.
struct HolePatch {
  Points points;                    ///< (n + m)×3
  std::vector<HoleTriangle> faces;  ///< oriented along the loop, corners in any order
  /// Per new point: two loop points and the parameter between them, for interpolating attributes.
  std::vector<EdgePoint> between;
};

struct HoleRefinementOptions {
  /// Mean edge length at each loop point, n, model units.
  std::vector<double> scale{};
  /// Edges of the surface between loop points, smaller index first, ascending.
  std::vector<HoleChord> forbidden{};
};

/// Inserts points into the triangles of a hole until its edges are about as long as those around it. A
/// triangle is split at its centroid if √2 × the distances to its corners exceed the scale there (Liepa 2003,
/// section 3). Flips edges to increase the smallest angles. The edges of the loop stay. Throws
/// Error(cancelled).
HolePatch refine_hole(const Points& loop, const std::vector<HoleTriangle>& triangles,
                      const HoleRefinementOptions& options, const Context& context = {});

/// Moves the new points of a hole to minimise bending, with all other points fixed (Botsch & Kobbelt 2004,
/// Eq. 4). Minimises the sum of squared Laplacians ‖M^{-1/2} K x‖² over the new and the loop points (K with
/// cotangent weights, M areas). `around` has the surface's triangles at the loop; they continue the tangent
/// planes at the loop. Their corners are loop points (< n) or, from n + m on, rows of `outside`. Throws
/// Error(cancelled).
void fair_hole(HolePatch& patch, const Points& outside, std::span<const HoleTriangle> around,
               const Context& context = {});

}  // namespace meshgraft
