#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Flips edges of a surface until the angles opposite each edge sum to at most 180° (Delaunay). An edge is
/// flipped only if its two faces are consistently oriented and nearly coplanar. It is not flipped if the new
/// edge already exists.
void flip_to_delaunay(const Points& points, Triangles& triangles);

}  // namespace meshgraft
