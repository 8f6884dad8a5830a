#include "refine_source.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <ranges>
#include <utility>

#include <meshgraft/mesh/topology.h>

#include "graft.h"
#include "mesh/refine.h"

namespace meshgraft {

namespace {

constexpr int most_levels = 6;  // chosen: edges are at most 64 times shorter afterwards

/// Returns the vertices of a refined loop: the old ones and, between them, those that halve its edges.
std::vector<Index> refined_loop(const std::vector<Index>& loop,
                                const std::map<std::array<Index, 2>, Index>& middle) {
  std::vector<Index> refined;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const auto [low, high] = std::minmax(loop[i], loop[(i + 1) % loop.size()]);
    refined.push_back(loop[i]);
    if (const auto found = middle.find({low, high}); found != middle.end()) refined.push_back(found->second);
  }
  return refined;
}

void take_refined(RefinedSource& source, RefineResult refined) {
  std::map<std::array<Index, 2>, Index> middle;
  for (std::size_t k = 0; k < refined.parents.size(); ++k) {
    const auto [low, high] = std::minmax(refined.parents[k][0], refined.parents[k][1]);
    middle[{low, high}] = source.mesh.vertex_count() + static_cast<Index>(k);
  }
  source.added += static_cast<Index>(refined.parents.size());
  source.mesh = std::move(refined.mesh);
  for (LoopPair& pair : source.pairs) pair.source = refined_loop(pair.source, middle);
}

/// Halves the source's edges around loops that have less than 1/edge_ratio as many vertices as their target
/// loops (design: "few boundary vertices for a large region").
void refine_around_loops(RefinedSource& source, double edge_ratio, const Context& context) {
  constexpr int rings_around = 2;  // chosen
  const auto is_coarse = [&](const LoopPair& pair) {
    return static_cast<double>(pair.target.size()) > edge_ratio * static_cast<double>(pair.source.size());
  };
  for (int level = 0; level < most_levels && std::ranges::any_of(source.pairs, is_coarse); ++level) {
    const IndexLists rings = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
    std::vector<Index> coarse;
    for (const LoopPair& pair : source.pairs) {
      if (!is_coarse(pair)) continue;
      const std::vector<Index> vertices = grow_rings(pair.source, rings_around, rings);
      coarse.insert(coarse.end(), vertices.begin(), vertices.end());
    }
    take_refined(source, split_edges_within(source.mesh, coarse, context));
  }
}

/// Halves the source's edges within its loops' radii that are too long for the source to bend there. Edges of
/// a loop are halved only where the loop has very few vertices.
void refine_within_radii(RefinedSource& source, const Context& context) {
  // × the loop's radius; measured: of 150 coarse pegs none is squeezed to half (docs/merging.md, "Seam").
  constexpr double longest_rel = 0.35;
  constexpr double rounding = 1e-9;          // the decision does not depend on the pose of the source
  constexpr std::size_t fewest_around = 12;  // chosen: edges of a regular loop are half its radius
  for (int level = 0; level < most_levels; ++level) {
    const Points& points = source.mesh.positions;
    const IndexLists rings = vertex_rings(source.mesh.vertex_count(), source.mesh.faces);
    std::vector<double> longest(points.rows(), std::numeric_limits<double>::infinity());
    Flags keeps_its_loop(longest.size(), false);
    for (const LoopPair& pair : source.pairs) {
      const double radius = loop_radius(points, pair.source);
      const std::vector<double> distance = edge_distance(pair.source, points, rings, {.limit = radius});
      for (std::size_t v = 0; v < longest.size(); ++v)
        if (distance[v] <= radius) longest[v] = std::min(longest[v], longest_rel * radius);
      for (const Index v : pair.source) keeps_its_loop[v] = pair.source.size() >= fewest_around;
    }
    const auto is_long = [&](Index a, Index b) {
      return !(keeps_its_loop[a] && keeps_its_loop[b]) &&
             (points.row(a) - points.row(b)).norm() > (1 + rounding) * std::min(longest[a], longest[b]);
    };
    const auto has_long_edge = [&](Index v) {
      return std::ranges::any_of(rings[v], [&](Index other) { return is_long(v, other); });
    };
    if (std::ranges::none_of(std::views::iota(Index{0}, source.mesh.vertex_count()), has_long_edge)) return;
    take_refined(source, split_edges(source.mesh, is_long, context));
  }
}

}  // namespace

RefinedSource refine_source(Mesh source, std::vector<LoopPair> pairs, const SeamOptions& options,
                            const Context& context) {
  RefinedSource refined{std::move(source), std::move(pairs), 0};
  refine_around_loops(refined, options.edge_ratio, context);
  if (options.refine_radius) refine_within_radii(refined, context);
  return refined;
}

}  // namespace meshgraft
