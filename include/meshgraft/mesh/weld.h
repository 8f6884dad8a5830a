#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Which vertices of a boundary lie at exactly the same place: the copies that a soup (every face with
/// vertices of its own) or a seam (of UVs, of hard edges, of a material) makes of what is one point.
struct Weld {
  std::vector<Index> representative;  ///< per vertex: the smallest of its place; empty if none coincide
  Index copies = 0;                   ///< vertices that another one represents

  bool empty() const { return representative.empty(); }
  Index of(Index vertex) const { return empty() ? vertex : representative[static_cast<std::size_t>(vertex)]; }
};

/// The coincident vertices at the ends of boundary edges that lie on each other ("duplicate-vertex" in the
/// diagnostics). Parts that touch in points, or along edges that are no boundary, stay apart, and so do
/// vertices that are not finite. Linear time.
Weld coincident_boundary(const Mesh& mesh, const Context& context = {});

/// The same where it is known which vertices coincide with others: `vertices`, ascending.
Weld weld_at(const Mesh& mesh, std::span<const Index> vertices);

/// The mesh with its faces on the representatives. Vertices keep their numbers (a copy is left without a face);
/// every vertex attribute is one of the corners, so that what differed across a seam still differs. Without a
/// source document. `weld` must be of this mesh.
Mesh welded(const Mesh& mesh, const Weld& weld);

/// Takes positions and attributes of `moved`, a welded mesh with the same faces, back to the mesh that it was
/// made of: copies go where their representative is.
void unweld(const Mesh& moved, const Weld& weld, Mesh& mesh);

}  // namespace meshgraft
