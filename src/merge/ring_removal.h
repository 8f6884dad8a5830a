#pragma once

#include <array>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A loop of a target whose ring is to be removed.
struct RingRequest {
  std::vector<Index> loop;  ///< in the direction of the mesh's half-edges
  double longest_edge = 0;  ///< upper bound on the mean edge length along the loop
  Location location;        ///< names the pair in messages
};

/// A mesh without the rings of its loops.
struct RingRemoval {
  Mesh mesh;        ///< kept vertices in their order, then those that halving the rings' edges added
  IndexMap vertex;  ///< from the vertices of the given mesh
  std::vector<std::vector<Index>> loops;  ///< in place of the given ones, beginning with the smallest vertex
  std::vector<int> halvings;              ///< per loop: how often its edges were halved first
};

/// Removes the vertices of boundary loops and the faces at them. First halves the edges at a loop (nothing
/// beyond its ring changes) until they are short enough and each ring is an annulus. The remaining surface
/// has one simple loop in place of each old one and is otherwise the same. Throws Error(input), naming the
/// pair, where four halvings do not make a ring an annulus.
RingRemoval remove_rings(const Mesh& mesh, std::span<const RingRequest> requests, const Context& context);

}  // namespace meshgraft
