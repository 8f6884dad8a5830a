#pragma once

#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A bipartite graph, stored as edge lists of the left vertices. An edge may occur more than once.
struct BipartiteGraph {
  std::vector<int> begin{0};  ///< per left vertex: its first edge in `right_end`; one more at the end
  std::vector<int> right_end;
  int right_count = 0;

  int left_count() const { return static_cast<int>(begin.size()) - 1; }
};

/// A set of edges without common vertices.
struct Matching {
  std::vector<int> of_left, of_right;  ///< per vertex: its partner, or -1
};

/// Returns a matching with as many edges as possible, in O(edges · √vertices) (Hopcroft & Karp 1973).
Matching maximum_matching(const BipartiteGraph& graph);

/// Flags the vertices of a vertex cover, which touch every edge of a bipartite graph.
struct VertexCover {
  Flags left, right;
};

/// Returns the cover with the fewest vertices. Among several, it is the one with the most left vertices.
/// There is only one such cover, so the order of edges does not matter. `matching` must be a maximum
/// matching.
VertexCover minimum_vertex_cover(const BipartiteGraph& graph, const Matching& matching);

}  // namespace meshgraft
