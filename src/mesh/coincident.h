#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"
#include "simple_surface.h"

namespace meshgraft {

/// Returns for each of `vertices` (ascending) the smallest of them at exactly the same position. A non-finite
/// vertex coincides only with itself.
std::vector<Index> coincident_classes(const Points& positions, std::span<const Index> vertices);

/// Returns the ends of edges with one face, ascending.
std::vector<Index> boundary_vertices(Index vertex_count, const EdgeTable& table);

/// Returns groups of two or more boundary half-edges that run between the same two positions, in either
/// direction; each row ascends. `representative` has for each vertex of the mesh the smallest vertex at its
/// position, or -1 to exclude it.
IndexLists coincident_boundary_edges(const EdgeTable& table, std::span<const Index> representative);

/// Returns the boundary vertices, ascending, that must be merged to join coincident boundary edges. They lie
/// at exactly the same position as another end of such an edge. Vertices whose boundaries touch only in a
/// point are excluded.
std::vector<Index> open_seam_vertices(const Mesh& mesh, const EdgeTable& table);

/// Returns the same for a mesh with a simple surface.
std::vector<Index> open_seam_vertices(const Mesh& mesh, const SimpleSurface& surface);

}  // namespace meshgraft
