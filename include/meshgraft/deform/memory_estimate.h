#pragma once

#include <cstdint>

#include <meshgraft/deform/deformer.h>

namespace meshgraft {

/// About how many bytes a `Deformer` of a region with that many free vertices needs for its solver,
/// before anything is made of it: what `SolverStatistics::peak_memory_bytes` will tell, within a factor of two
/// on regions of 1,000 to 160,000 vertices (measured on sheets, tubes, bars, spheres and tori). The whole
/// set-up takes up to twice that. Throws Error(input) for a negative number.
std::int64_t estimated_memory(Index free_vertices, const DeformerOptions& options = {});

/// How a region is solved.
enum class SolvePath {
  direct,     ///< by a factor of its matrix
  iterative,  ///< the same solution by iterations (SolverBackend::iterative)
  proxy,      ///< a decimated proxy's (ProxyDeformer), which the region follows
};

/// What suits a region with so many free vertices where no backend is asked for: the direct solve up to a
/// million of them if its set-up fits the memory (bytes), else iterations if those do, else a proxy. With a
/// backend that is asked for: that, or a proxy where it does not fit.
SolvePath choose_path(Index free_vertices, const DeformerOptions& options, std::uint64_t memory);

/// About how many vertices a proxy may have so that its solve takes a quarter of the memory; at least 2,000.
Index proxy_vertices_for(const DeformerOptions& options, std::uint64_t memory);

}  // namespace meshgraft
