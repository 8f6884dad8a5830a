#include "match_loops.h"

#include <algorithm>
#include <map>

#include <meshgraft/mesh/normals.h>

#include "loops.h"
#include "match_by_arc_length.h"

namespace meshgraft {

std::vector<PairGeometry> pair_geometry(const Mesh& target, const Mesh& source, std::span<const LoopPair> pairs,
                                        bool smooth) {
  const Points target_normals = vertex_normals(target), source_normals = vertex_normals(source);
  std::vector<PairGeometry> geometry;
  for (std::size_t p = 0; p < pairs.size(); ++p) {
    geometry.push_back({pairs[p], loop_geometry(source, source_normals, pairs[p].source),
                        loop_geometry(target, target_normals, pairs[p].target),
                        pair_location(p, pairs.size())});
    if (!smooth) continue;
    for (LoopGeometry* loop : {&geometry.back().source, &geometry.back().target})
      loop->points = smoothed_loop(loop->points);
  }
  return geometry;
}

std::vector<std::vector<std::size_t>> pairs_by_component(std::span<const PairGeometry> pairs,
                                                         const std::vector<Index>& component) {
  std::map<Index, std::vector<std::size_t>> members;
  for (std::size_t p = 0; p < pairs.size(); ++p) members[component[pairs[p].loops.source.front()]].push_back(p);
  std::vector<std::vector<std::size_t>> lists;
  for (auto& [number, list] : members) lists.push_back(std::move(list));
  return lists;
}

std::vector<Correspondence> match_loops(std::span<const PairGeometry> pairs, std::span<const MergePair> given,
                                        const std::vector<Index>& component, bool posed,
                                        const ModelOrientations& orientations) {
  std::vector<Correspondence> found(pairs.size());
  for (std::size_t p = 0; p < pairs.size(); ++p)
    if (!given[p].matches.empty()) found[p] = match_by_arc_length(pairs[p], given[p].matches);
  for (std::vector<std::size_t>& members : pairs_by_component(pairs, component)) {
    std::erase_if(members, [&](std::size_t p) { return !given[p].matches.empty(); });
    if (members.empty()) continue;
    std::vector<PairGeometry> chosen;
    for (const std::size_t p : members) chosen.push_back(pairs[p]);
    std::vector<Correspondence> matched = match_automatically(chosen, posed, orientations);
    for (std::size_t k = 0; k < members.size(); ++k) found[members[k]] = std::move(matched[k]);
  }
  return found;
}

}  // namespace meshgraft
