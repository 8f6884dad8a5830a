#pragma once

#include <array>
#include <functional>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns whether two triangles, given by their rows, have more in common than their shared vertices and
/// edges. Two with the same vertices do not, nor does a triangle without area. Exact.
bool intersect(const Points& points, const Triangles& triangles, const std::array<Index, 2>& pair);

/// Calls `found` once for each pair of triangles that intersect and of which at least one is flagged in `free`,
/// the smaller row first. Several threads call it at the same time, in no fixed order. All vertices must exist.
/// Reports progress as the stage "intersections".
void find_intersections(const Points& points, const Triangles& triangles, const Flags& free,
                        const std::function<void(const std::array<Index, 2>&)>& found, const Context& context);

}  // namespace meshgraft
