#pragma once

#include <cstddef>
#include <initializer_list>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "binary_message.h"
#include "folders.h"
#include "objects.h"

namespace meshgraft::editor {

/// Returns the mesh of an object: positions, triangles, normals, uv and colours where it has them, and
/// texture images. Images are included where they lie in `folders` or in the object's own file. `role` is
/// "model" or "part".
std::vector<std::byte> mesh_frame(const Object& object, std::string_view role, const Folders& folders);

/// Adds positions relative to `offset`, triangles, normals, uv and colours of a mesh.
void add_surface(BinaryMessage& message, const Mesh& mesh, const Triangles& triangles,
                 const Eigen::RowVector3d& offset);

/// Adds the uv of the corners of triangles, 2 numbers each, where the mesh has them. `faces`: per triangle, the
/// face that contains it.
void add_corner_uv(BinaryMessage& message, const Mesh& mesh, const Triangles& triangles,
                   const std::vector<Index>& faces);

/// Adds, per triangle, the number of its texture image. The images themselves are those that the page has from
/// the messages of `senders`: each is named by the number of that mesh and its number there.
void add_shared_pictures(BinaryMessage& message, const Mesh& mesh, const std::vector<Index>& faces,
                         std::initializer_list<const Object*> senders);

/// Returns the boundary loops of an object.
std::vector<std::byte> loops_frame(const Object& object);

/// Returns the vertices of `base` that move with the region, ascending. The region is one of the welded mesh,
/// where there is one.
std::vector<Index> moving_vertices(const Object& base, const Region& region);

/// Returns the positions of `moving`; where most vertices move, those of all vertices.
std::vector<std::byte> position_frame(const Object& base, const std::vector<Index>& moving,
                                      const LiveFrame& frame);

/// Returns the weights with which a vertex shader moves the mesh by its handles.
std::vector<std::byte> weights_frame(const Object& base, const HandleBasis& basis);

std::vector<std::byte> selection_frame(const Object& base, const std::vector<Index>& selection);

/// Returns the role of each vertex: in the region, fixed, or in a handle.
std::vector<std::byte> roles_frame(const Object& base, const Region& region);

}  // namespace meshgraft::editor
