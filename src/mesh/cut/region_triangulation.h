#pragma once

#include <array>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>

#include "cap_region.h"

namespace meshgraft {

/// Triangulates a region by its outlines' points alone, counter-clockwise. The outlines must not cross or
/// touch. Inner outlines are joined with the outer one by bridges, ears are clipped by exact predicates, and
/// edges are flipped until they are Delaunay. Takes quadratic time. Throws Error(cancelled).
std::vector<std::array<Index, 3>> triangulate_region(std::span<const Point2> points, const CapRegion& region,
                                                     const Context& context = {});

}  // namespace meshgraft
