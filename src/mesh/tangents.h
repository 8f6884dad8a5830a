#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Updates the tangents as part of `update_normals`, after the normals. `moved` flags the faces with a moved
/// vertex.
void update_tangents(Mesh& mesh, const Points& rest, const Flags& moved);

}  // namespace meshgraft
