#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

#include "seam_patch.h"

namespace meshgraft {

/// Moves vertices until no edge of a strip is bent by more than an angle, as far as that is possible: lowers
/// Σ max(0, θ - θ₀)² over the edges, θ the bend (radians, 0 is flat), and Σ max(0, q - q₀)² over the triangles,
/// q the harmonic index (Σ of the angles' cotangents), one vertex after another. What is worse than allowed off
/// the strips may stay so, but gets no worse. A crease may go on: an edge between two vertices may be bent as
/// much as the sharpest edges off the strips at both of them. `may_move`: per vertex.
void reduce_folds(Points& points, const SeamPatch& patch, double largest_deg, const Flags& may_move,
                  const Context& context);

}  // namespace meshgraft
