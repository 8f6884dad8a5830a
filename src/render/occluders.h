#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "mesh/ray_tracer.h"

namespace meshgraft::render {

/// The triangles that can block a ray, and the height above a surface at which rays begin, so that it does not
/// block them itself.
struct Occluders {
  std::vector<RayTriangle> triangles;
  float lift;
};

/// Returns the given triangles. Where there are many, returns those of a coarser surface instead: the vertices
/// in each cell of a grid become one (Rossignac and Borrel 1993). `cell` is the length of its sides.
Occluders make_occluders(const std::vector<Eigen::Vector3f>& points, const Triangles& triangles, float cell,
                         const Context& context);

}  // namespace meshgraft::render
