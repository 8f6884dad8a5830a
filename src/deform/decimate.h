#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A coarse triangulation of a surface on some of its vertices.
struct Decimated {
  std::vector<Index> vertices;  ///< of the surface, ascending
  Triangles triangles;          ///< indices into `vertices`
};

/// Collapses edges (meshoptimizer) until about `target` vertices are left, evenly spread; `locked` flags those
/// that stay. Fewer are collapsed where the topology forbids it. `normals` are the surface's unit normals.
/// Vertices of no face are left out. `target` is less than all.
Decimated decimate(const Points& points, const Triangles& triangles, const Points& normals,
                   std::span<const std::uint8_t> locked, Index target);

}  // namespace meshgraft
