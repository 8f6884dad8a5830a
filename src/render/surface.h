#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "render/render.h"

namespace meshgraft::render {

using Vec3 = Eigen::Vector3f;

/// One shape, triangulated, with a normal per corner.
struct Surface {
  Points positions;
  Triangles triangles;
  std::vector<Vec3> corner_normals;
  std::vector<Vec3> colours;  // per vertex, or empty
  /// Per triangle, bit c: the edge opposite corner c belongs to the face. Empty unless they are drawn.
  std::vector<std::uint8_t> outlines;
};

/// Triangulates a shape. Faces with a vertex that is not finite are left out. Throws Error(input) if the shape
/// has not one colour per vertex.
Surface prepare(const Shape& shape, const RenderOptions& options, const Context& context);

}  // namespace meshgraft::render
