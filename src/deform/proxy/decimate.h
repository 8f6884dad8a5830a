#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A coarse triangulation of a surface on some of its vertices.
struct Decimated {
  std::vector<Index> vertices;  ///< indices into the surface, ascending
  Triangles triangles;          ///< indices into `vertices`
};

/// Collapses edges (meshoptimizer) until about `target` evenly spread vertices are left. Large surfaces are
/// first thinned in chunks, in parallel; the result is the same for any number of threads. `locked` flags
/// vertices that no collapse removes. More vertices are left where the topology forbids collapses. `normals`
/// are the surface's unit normals. Vertices without a face are left out. So are those of pockets, whose faces
/// lie back to back after the collapses, even where they are locked. `target` must be less than the number
/// of vertices. Stops waiting for meshoptimizer when a stop is requested, and throws Error(cancelled).
Decimated decimate(const Points& points, const Triangles& triangles, const Points& normals,
                   std::span<const std::uint8_t> locked, Index target, const Context& context = {});

}  // namespace meshgraft
