#pragma once

#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "edge_table.h"

namespace meshgraft {

/// For each of `vertices` (ascending) the smallest of them that is at exactly the same place; non-finite ones
/// are alone.
std::vector<Index> coincident_classes(const Points& positions, std::span<const Index> vertices);

/// Vertices at the ends of edges with one face, ascending.
std::vector<Index> boundary_vertices(Index vertex_count, const EdgeTable& table);

/// Half-edges on the boundary that run between the same two places, two or more a row, each row ascending.
/// `representative` has for each vertex of the mesh the smallest vertex at its place, -1 where it is of no
/// interest.
IndexLists coincident_boundary_edges(const EdgeTable& table, std::span<const Index> representative);

/// Boundary vertices, ascending, that would have to be one with others for boundary edges to meet: those at
/// exactly the same place, at the ends of edges that lie on each other. Places that meet in a point alone are
/// not among them.
std::vector<Index> torn_vertices(const Mesh& mesh, const EdgeTable& table);

}  // namespace meshgraft
