#pragma once

#include <array>
#include <vector>

#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// The edges of a polygon mesh and the half-edges along them, for any input. Half-edge c starts at corner c
/// and ends at corner next[c]. A corner that repeats the preceding one is skipped. A face with an index out
/// of range, or with fewer than three corners left, is unusable: its corners have next = edge = -1.
struct EdgeTable {
  EdgeTable(Index vertex_count, const Faces& faces);

  Index edge_count() const { return half_edges.size(); }
  bool is_boundary(Index half_edge) const { return half_edges[edge[half_edge]].size() == 1; }

  std::vector<Index> next;                 ///< per corner: the following corner of its face
  std::vector<Index> previous;             ///< per corner: the preceding corner of its face
  std::vector<Index> edge;                 ///< per corner: the edge of its half-edge
  IndexLists half_edges;                   ///< per edge: its half-edges, ascending
  std::vector<std::array<Index, 2>> ends;  ///< per edge: smaller and larger vertex; edges ascend in them
  Index usable_faces = 0;                  ///< faces with links
};

}  // namespace meshgraft
