#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The tangents' part of `update_normals`, to be called when the normals are new. `moved` tells the faces of
/// which a vertex moved.
void update_tangents(Mesh& mesh, const Points& rest, const Flags& moved);

}  // namespace meshgraft
