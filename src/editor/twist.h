#pragma once

#include <meshgraft/merge/correspondence.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::editor {

/// The start that is turned by an angle along the target's loop against `start`: of all vertices of both
/// boundary loops the two that come nearest, so that coarse loops turn finely, too. Throws Error(input) where
/// `start` is on no loop of the meshes.
Match twisted_start(const Mesh& source, const Mesh& target, const Match& start, double by_deg);

}  // namespace meshgraft::editor
