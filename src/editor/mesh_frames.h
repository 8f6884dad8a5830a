#pragma once

#include <cstddef>
#include <vector>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/handle_basis.h>
#include <meshgraft/deform/live_deformer.h>

#include "step_base.h"

namespace meshgraft::editor {

/// The mesh of a step as it finds it: positions, triangles, normals, and uv and colour where vertices have
/// them.
std::vector<std::byte> mesh_frame(const StepBase& base);

/// Which vertices of `base` move with the region (of its welded mesh, where there is one), ascending.
std::vector<Index> moving_vertices(const StepBase& base, const Region& region);

/// Where `moving` are; all vertices are sent where most of them move.
std::vector<std::byte> position_frame(const StepBase& base, const std::vector<Index>& moving,
                                      const LiveFrame& frame);

/// What moves the mesh by its handles in a vertex shader.
std::vector<std::byte> weights_frame(const StepBase& base, const HandleBasis& basis);

std::vector<std::byte> selection_frame(const StepBase& base, const std::vector<Index>& selection);

/// Who is what: the region, what stays, each handle.
std::vector<std::byte> roles_frame(const StepBase& base, const Region& region);

}  // namespace meshgraft::editor
