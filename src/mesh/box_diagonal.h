#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The diagonal of the bounding box of points; those that are not finite do not count. 0 without any.
double box_diagonal(const Points& points);

/// The same of the vertices that faces have: a stray vertex does not count.
double box_diagonal_of_faces(const Mesh& mesh);

}  // namespace meshgraft
