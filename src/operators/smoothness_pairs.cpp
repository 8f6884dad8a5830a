#include "smoothness_pairs.h"

#include <algorithm>

#include "core/parallel.h"

namespace meshgraft {

std::vector<std::array<Index, 2>> smoothness_pairs(const Triangles& triangles,
                                                   const IndexLists& vertex_triangles, const IndexLists& rings,
                                                   std::span<const std::uint8_t> active, bool opposite_pairs,
                                                   const Context& context) {
  // Lists for each vertex its partners with a larger number, by blocks of vertices.
  constexpr std::size_t block_size = 1024;
  const auto count = static_cast<std::size_t>(rings.size());
  std::vector<std::vector<std::array<Index, 2>>> blocks((count + block_size - 1) / block_size);
  const auto list_partners = [&](Index i, std::vector<Index>& partners) {
    partners.assign(rings[i].begin(), rings[i].end());
    for (const Index t : vertex_triangles[i]) {
      // Adds the third corners of the other faces at the opposite edge.
      std::array<Index, 2> edge{-1, -1};
      for (int corner = 0, end = 0; corner < 3; ++corner)
        if (triangles(t, corner) != i && end < 2) edge[end++] = triangles(t, corner);
      if (!opposite_pairs || edge[1] < 0 || edge[0] == edge[1]) continue;
      for (const Index other : vertex_triangles[edge[0]]) {
        const auto corners = triangles.row(other);
        if (other == t || (corners.array() != edge[1]).all()) continue;
        for (const Index v : corners)
          if (v != edge[0] && v != edge[1]) partners.push_back(v);
      }
    }
    std::sort(partners.begin(), partners.end());
    partners.erase(std::unique(partners.begin(), partners.end()), partners.end());
  };
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<Index> partners;
        for (std::size_t block = begin; block < end; ++block)
          for (auto i = static_cast<Index>(block * block_size);
               i < static_cast<Index>(std::min(count, (block + 1) * block_size)); ++i) {
            list_partners(i, partners);
            for (const Index j : partners)
              if (i < j && (active[i] || active[j])) blocks[block].push_back({i, j});
          }
      },
      context, 1);
  std::vector<std::array<Index, 2>> pairs;
  for (const auto& block : blocks) {
    context.throw_if_stopped();
    pairs.insert(pairs.end(), block.begin(), block.end());
  }
  return pairs;
}

}  // namespace meshgraft
