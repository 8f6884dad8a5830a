#include "fans.h"

#include "disjoint_sets.h"

namespace meshgraft {

std::vector<Index> fan_counts(const Mesh& mesh, const EdgeTable& table) {
  const std::vector<Index>& corners = mesh.faces.corners();
  DisjointSets fans(mesh.faces.corner_count());  // of corners at the same vertex
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto along = table.half_edges[e];
    for (std::size_t k = 1; k < along.size(); ++k) {
      const bool same_tail = corners[along[0]] == corners[along[k]];
      fans.unite(along[0], same_tail ? along[k] : table.next[along[k]]);
      fans.unite(table.next[along[0]], same_tail ? table.next[along[k]] : along[k]);
    }
  }
  std::vector<Index> counts(mesh.vertex_count(), 0);
  for (Index c = 0; c < mesh.faces.corner_count(); ++c) {
    if (table.next[c] >= 0 && fans.root(c) == c) ++counts[corners[c]];
  }
  return counts;
}

std::optional<bool> consistently_oriented(const Mesh& mesh, const EdgeTable& table, Index edge) {
  const auto along = table.half_edges[edge];
  if (along.size() != 2) return std::nullopt;
  return mesh.faces.corners()[along[0]] != mesh.faces.corners()[along[1]];
}

}  // namespace meshgraft
