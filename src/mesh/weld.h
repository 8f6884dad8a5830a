#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Welds coincident vertices: `vertices`, ascending, as a finding of the kind duplicate_vertex lists them.
/// Takes linear time.
Weld weld_at(const Mesh& mesh, std::span<const Index> vertices);

/// Returns the mesh with its faces on the representatives. Vertices keep their indices, and a copy is left
/// without a face. Every vertex attribute becomes a corner attribute, so that values that differed across a
/// seam still differ. The result has no source document. `weld` must belong to this mesh.
Mesh welded(const Mesh& mesh, const Weld& weld);

/// Copies positions and attributes of `moved`, a welded mesh with the same faces, back to the mesh it was
/// made from. Copies move to their representative's position.
void unweld(const Mesh& moved, const Weld& weld, Mesh& mesh);

}  // namespace meshgraft
