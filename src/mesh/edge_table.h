#pragma once

#include <array>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The edges of a polygon mesh and the half-edges along them, for any input that does not change meanwhile.
/// Half-edge c starts at corner c and ends at corner next[c]. A corner that repeats the preceding one is
/// skipped. A face with an index out of range, or with fewer than three corners left, is unusable: its corners
/// have next = edge = -1.
struct EdgeTable {
  EdgeTable(Index vertex_count, const Faces& faces, const Context& context = {});

  Index edge_count() const { return half_edges.size(); }
  bool is_boundary(Index half_edge) const { return half_edges[edge[half_edge]].size() == 1; }

  std::vector<Index> next;                 ///< per corner: the following corner of its face
  std::vector<Index> previous;             ///< per corner: the preceding corner of its face
  std::vector<Index> edge;                 ///< per corner: the edge of its half-edge
  IndexLists half_edges;                   ///< per edge: its half-edges, ascending
  std::vector<std::array<Index, 2>> ends;  ///< per edge: smaller and larger vertex; edges ascend in them
  Index usable_faces = 0;                  ///< faces with links
};

/// An edge of a triangle mesh, without its half-edges.
struct TriangleEdge {
  std::array<Index, 2> ends{-1, -1};   ///< smaller and larger vertex
  std::array<Index, 2> faces{-1, -1};  ///< its first two faces, ascending; -1: there is none
  Index forward = 0, backward = 0;     ///< number of faces that run from ends[0] to ends[1], and of the others

  bool joins_two_faces() const { return forward + backward == 2; }
  /// Returns whether as many faces run one way as the other; false for a boundary edge.
  bool is_balanced() const { return forward == backward; }
};

/// Lists the edges of a triangle mesh, ascending in their ends. A triangle that repeats a vertex has no edges.
/// If the lists of `vertex_triangles` exist anyway, this takes half the memory of an EdgeTable, and less
/// time if neighbouring vertices have near numbers.
std::vector<TriangleEdge> list_edges(const Triangles& triangles, const IndexLists& vertex_triangles,
                                     const Context& context = {});

/// Lists those edges whose smaller vertex is in [first, last).
std::vector<TriangleEdge> list_edges_from(Index first, Index last, const Triangles& triangles,
                                          const IndexLists& vertex_triangles, const Context& context = {});

}  // namespace meshgraft
