#pragma once

#include <cstddef>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle_basis.h>
#include <meshgraft/deform/live_deformer.h>

#include "binary_frame.h"
#include "folders.h"
#include "objects.h"

namespace meshgraft::editor {

/// The mesh of an object: positions, triangles, normals, uv and colour where there are any, and the pictures of
/// its materials that lie in `folders` or in its own file. `role` is "model" or "part".
std::vector<std::byte> mesh_frame(const Object& object, std::string_view role, const Folders& folders);

/// Positions relative to `offset`, triangles, normals, uv and colours of a mesh.
void add_surface(BinaryFrame& frame, const Mesh& mesh, const Triangles& triangles,
                 const Eigen::RowVector3d& offset);

/// The boundary loops of an object.
std::vector<std::byte> loops_frame(const Object& object);

/// Which vertices of `base` move with the region (of its welded mesh, where there is one), ascending.
std::vector<Index> moving_vertices(const Object& base, const Region& region);

/// Where `moving` are; all vertices are sent where most of them move.
std::vector<std::byte> position_frame(const Object& base, const std::vector<Index>& moving,
                                      const LiveFrame& frame);

/// What moves the mesh by its handles in a vertex shader.
std::vector<std::byte> weights_frame(const Object& base, const HandleBasis& basis);

std::vector<std::byte> selection_frame(const Object& base, const std::vector<Index>& selection);

/// Who is what: the region, what stays, each handle.
std::vector<std::byte> roles_frame(const Object& base, const Region& region);

}  // namespace meshgraft::editor
