#pragma once

#include <cstdint>
#include <vector>

namespace meshgraft {

/// A bipartite graph by its left vertices. An edge may occur more than once.
struct BipartiteGraph {
  std::vector<int> begin{0};  ///< of each left vertex's edges in `right_end`; one more at the end
  std::vector<int> right_end;
  int right_count = 0;

  int left_count() const { return static_cast<int>(begin.size()) - 1; }
};

/// Edges no two of which share a vertex.
struct Matching {
  std::vector<int> of_left, of_right;  ///< each vertex's partner, -1 where it has none
};

/// Returns a matching with as many edges as possible, in O(edges · √vertices) (Hopcroft & Karp 1973).
Matching maximum_matching(const BipartiteGraph& graph);

/// Vertices that touch every edge of a bipartite graph: a flag for each.
struct VertexCover {
  Flags left, right;
};

/// Returns the cover with the fewest vertices; of several, the one with the most left vertices. There is only
/// one such cover, so the order of edges does not matter. `matching` is a maximum one.
VertexCover minimum_vertex_cover(const BipartiteGraph& graph, const Matching& matching);

}  // namespace meshgraft
