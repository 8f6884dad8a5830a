#pragma once

#include <cstdint>

#include <meshgraft/deform/deformer.h>

namespace meshgraft {

/// About how many bytes a `Deformer` of a region with that many free vertices needs for its factorisation,
/// before anything is made of it: what `SolverStatistics::peak_memory_bytes` will tell, within a factor of 1.5
/// on regions of 1,000 to 160,000 vertices (measured on sheets, tubes, bars, spheres and tori). The whole
/// set-up takes up to twice that. Throws Error(input) for a negative number.
std::int64_t estimated_memory(Index free_vertices, const DeformerOptions& options = {});

}  // namespace meshgraft
