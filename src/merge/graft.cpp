#include "graft.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <limits>

#include <meshgraft/mesh/topology.h>

namespace meshgraft {

namespace {

// Bits of `taken`, for vertices that are not simply free: the vertex belongs to a feature, or stays in place.
constexpr std::uint8_t of_feature = 1, stays = 2;

/// Returns `radii` × the loop's own radius, limited to half the distance to the farthest vertex.
double default_radius(const Points& points, const IndexLists& rings, const std::vector<Index>& loop,
                      double radii) {
  double farthest = 0;
  for (const double distance : edge_distance(loop, points, rings))
    if (std::isfinite(distance)) farthest = std::max(farthest, distance);
  return std::min(radii * loop_radius(points, loop), farthest / 2);
}

/// Adds one similarity feature for the far part of each component. Its scale is that of the posed source if
/// the scale is given.
void add_far_parts(std::span<const Index> far, const std::vector<Index>& component, bool scale_given,
                   std::vector<Feature>& features) {
  std::vector<Index> sorted(far.begin(), far.end());
  std::stable_sort(sorted.begin(), sorted.end(), [&](Index a, Index b) { return component[a] < component[b]; });
  for (std::size_t i = 0; i < sorted.size(); ++i) {
    if (i == 0 || component[sorted[i]] != component[sorted[i - 1]]) {
      features.emplace_back();
      features.back().similarity = true;
      if (scale_given) features.back().scale = 1;
    }
    features.back().vertices.push_back(sorted[i]);
  }
}

}  // namespace

double loop_radius(const Points& points, const std::vector<Index>& loop) {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const Index v : loop) centre += points.row(v);
  centre /= static_cast<double>(loop.size());
  double sum = 0;
  for (const Index v : loop) sum += (points.row(v) - centre).squaredNorm();
  return std::sqrt(sum / static_cast<double>(loop.size()));
}

std::vector<Index> beyond_influence_radius(const Points& source, const IndexLists& rings,
                                           std::span<const std::vector<Index>> loops, const Reach& reach,
                                           double radii) {
  constexpr int fewest_rings = 2;
  Flags near(source.rows(), 0);
  for (const auto& loop : loops) {
    for (const Index v : grow_rings(loop, reach.rings.value_or(fewest_rings), rings)) near[v] = 1;
    if (reach.rings) continue;
    const double length = reach.length ? *reach.length : default_radius(source, rings, loop, radii);
    const std::vector<double> distance = edge_distance(loop, source, rings, {.limit = length});
    for (std::size_t v = 0; v < near.size(); ++v) near[v] |= static_cast<std::uint8_t>(distance[v] <= length);
  }
  std::vector<Index> far;
  for (Index v = 0; v < rings.size(); ++v)
    if (!near[v] && !rings[v].empty()) far.push_back(v);
  return far;
}

Graft solve_graft(const Points& source, const Triangles& triangles,
                  std::span<const VertexConstraint> constraints, std::span<const Index> far,
                  const std::vector<Index>& component, const MergeOptions& options, const Context& context) {
  DeformerOptions deformer_options = options.deformer;
  deformer_options.soften_coarse = false;  // softer parts invert more maps beside the seam
  if (options.shape == MergeShape::ft05) deformer_options.method = DeformMethod::ft05;

  Flags taken(source.rows(), 0);
  if (options.pose == MergePose::keep) {
    for (const Index v : far) taken[v] |= stays;
    for (const Index v : options.fixed) taken[v] |= stays;
    for (const VertexConstraint& held : constraints) taken[held.vertex] &= static_cast<std::uint8_t>(~stays);
  }
  std::vector<Feature> features;
  for (const MergeFeature& feature : options.features) {
    const auto is_in_source = [&](Index v) { return v >= 0 && v < static_cast<Index>(source.rows()); };
    // A feature that reaches into a fixed part has the map of that part, so all of it stays.
    const bool all_stays = std::any_of(feature.vertices.begin(), feature.vertices.end(),
                                       [&](Index v) { return is_in_source(v) && (taken[v] & stays) != 0; });
    for (const Index v : feature.vertices)
      if (is_in_source(v)) taken[v] |= all_stays ? stays : of_feature;
    if (!all_stays) features.push_back({feature.vertices, feature.similarity, {}});
  }
  std::vector<Index> region;  // empty: the whole source
  if (options.pose == MergePose::keep) {
    for (Index v = 0; v < static_cast<Index>(source.rows()); ++v)
      if ((taken[v] & stays) == 0) region.push_back(v);
  } else if (options.shape == MergeShape::similar) {
    std::vector<Index> open;
    std::copy_if(far.begin(), far.end(), std::back_inserter(open), [&](Index v) { return taken[v] == 0; });
    add_far_parts(open, component, options.size.has_value(), features);
  }
  const bool whole = region.empty();
  const Deformer deformer({source,
                           triangles,
                           {.vertices = std::move(region), .whole = whole, .features = std::move(features)},
                           {constraints.begin(), constraints.end()}},
                          deformer_options, context);
  Graft graft;
  graft.summary = deformer.summary();
  graft.positions = deformer.evaluate(constraints, context, &graft.evaluation);
  return graft;
}

}  // namespace meshgraft
