#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

#include "seam_patch.h"

namespace meshgraft {

/// Moves vertices until no edge of a strip is bent by more than an angle, as far as that is possible.
/// Minimises, one vertex after another, Σ max(0, θ - θ₀)² over the edges and Σ max(0, q - q₀)² over the
/// triangles. The bend θ is in radians, 0 where flat; q is the harmonic index (Σ of the angles' cotangents);
/// θ₀ and q₀ are the accepted values. Off the strips, an edge or triangle that exceeds its bound already may
/// stay so, but gets no worse. A crease may continue across a strip: an edge may be bent as much as the
/// sharpest edges off the strips at both of its vertices. `may_move`: per vertex.
void reduce_folds(Points& points, const SeamPatch& patch, double largest_deg, const Flags& may_move,
                  const Context& context);

}  // namespace meshgraft
