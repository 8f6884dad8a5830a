#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A loop of a target whose ring is to be taken away.
struct RingRequest {
  std::vector<Index> loop;  ///< in the direction of the mesh's half-edges
  double longest_edge = 0;  ///< the mean edge length that the edges at the loop should not exceed
  std::string location;     ///< names the pair in messages
};

/// A mesh without the rings of its loops.
struct RingRemoval {
  Mesh mesh;        ///< kept vertices in their order, then those that halving the rings' edges added
  IndexMap vertex;  ///< of the mesh that came in
  std::vector<std::vector<Index>> loops;  ///< in place of the given ones, beginning with the smallest vertex
  std::vector<int> halvings;              ///< per loop: how often the edges at it were halved first
};

/// Takes the vertices of boundary loops away with the faces at them. The edges at a loop are halved first
/// (nothing beyond its ring changes) until they are short enough, and until each ring is an annulus: what
/// remains has one simple loop in place of each old one and is else the same surface. Throws Error(input),
/// naming the place, where four halvings for that are not enough.
RingRemoval remove_rings(const Mesh& mesh, std::span<const RingRequest> requests, const Context& context);

}  // namespace meshgraft
