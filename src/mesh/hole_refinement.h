#pragma once

#include <functional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/interpolate_attribute.h>
#include <meshgraft/mesh/mesh.h>

#include "hole_search.h"

namespace meshgraft {

/// A filled hole: the n points of its loop, new ones behind them, and triangles between all of these.
struct HolePatch {
  Points points;                    ///< (n + m)×3
  std::vector<HoleTriangle> faces;  ///< wound along the loop, corners in any order
  /// Per new point two of the loop, and how far it is from the first one to the second: for attributes.
  std::vector<EdgePoint> between;
};

struct HoleRefinementOptions {
  /// n, per point of the loop the mean length of the edges there, model units.
  std::vector<double> scale{};
  /// Edges that the surface has between points of the loop (the smaller index first, ascending).
  std::vector<HoleChord> forbidden{};
};

/// Inserts points into the triangles of a hole until its edges are about as long as those around it, and flips
/// edges so that smallest angles grow (Liepa 2003, section 3: a triangle is split at its centroid where √2 ×
/// the distances to its corners exceed the scale there). The loop's edges stay. Throws Error(cancelled).
HolePatch refine_hole(const Points& loop, const std::vector<HoleTriangle>& triangles,
                      const HoleRefinementOptions& options, const Context& context = {});

/// Moves the new points of a hole so that the surface bends as little as it can: the smallest sum of squared
/// Laplacians ‖M^{-1/2} K x‖² (K with cotangent weights, M areas) over the new points and those of the loop,
/// the rest being fixed (Botsch & Kobbelt 2004, Eq. 4). `around` has triangles of the surface about the loop,
/// whose corners are points of the loop (< n) or, from n + m on, rows of `outside`: with them the tangent
/// planes at the loop go on, too. Throws Error(cancelled).
void fair_hole(HolePatch& patch, const Points& outside, std::span<const HoleTriangle> around,
               const Context& context = {});

}  // namespace meshgraft
