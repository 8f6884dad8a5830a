#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Flips edges of a surface until the angles opposite each of them sum up to at most 180° (Delaunay), where
/// that leaves the surface as it is: only edges between two consistently oriented faces that are nearly in one
/// plane, and none to an edge that is there already.
void flip_to_delaunay(const Points& points, Triangles& triangles);

}  // namespace meshgraft
