#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns the diagonal of the bounding box of the finite points, or 0 if there are none.
double box_diagonal(const Points& points);

/// Returns the diagonal of the bounding box of the vertices that faces use; isolated vertices do not count.
double box_diagonal_of_faces(const Mesh& mesh);

}  // namespace meshgraft
