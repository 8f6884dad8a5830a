#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include <meshgraft/core/context.h>

#include "samples.h"
#include "view.h"

namespace meshgraft::render {

constexpr std::uint32_t no_triangle = std::numeric_limits<std::uint32_t>::max();

/// Returns the triangle that each sample shows, or `no_triangle`: the visibility buffer (Burns and Hunt 2013).
/// `points` has the vertices in the coordinates of the camera.
std::vector<std::uint32_t> visible_triangles(const std::vector<Vec3>& points, const Triangles& triangles,
                                             const View& view, const Samples& samples, const Context& context);

}  // namespace meshgraft::render
