#include "surface_samples.h"

#include <algorithm>

#include "core/sparse_checks.h"
#include "mesh/shortest_distances.h"

namespace meshgraft {

namespace {

/// Distances along edges (Dijkstra) that are updated when a source is added.
class EdgeDistances {
 public:
  EdgeDistances(const Points& points, const IndexLists& rings, const Context& context)
      : points_(points),
        rings_(rings),
        check_(context, 1U << 14),
        distance_(rings.size(), unreached),
        source_(distance_.size(), -1) {}

  void add_source(Index vertex, Index number) {
    new_sources_.push_back(vertex);
    source_[vertex] = number;
  }

  /// Visits only vertices whose distance the new sources decrease.
  void update() {
    shortest_distances(new_sources_, distance_, [&](Index v, double distance, const auto& offer) {
      check_();
      for (const Index w : rings_[v])
        if (offer(w, distance + length(v, w))) source_[w] = source_[v];
      return true;
    });
    new_sources_.clear();
  }

  /// Forgets all sources, and measures from now on in units that grow with the distance found so far: they
  /// triple up to the farthest vertex.
  void grade() {
    double farthest = 0;
    for (const double distance : distance_)
      if (distance < unreached) farthest = std::max(farthest, distance);
    unit_.assign(distance_.size(), 1.0);
    for (std::size_t v = 0; v < distance_.size(); ++v)
      if (farthest > 0) unit_[v] += 2 * std::min(distance_[v] / farthest, 1.0);
    std::fill(distance_.begin(), distance_.end(), unreached);
  }

  double distance(Index vertex) const { return distance_[vertex]; }
  const std::vector<Index>& sources() const { return source_; }

 private:
  double length(Index v, Index w) const {
    const double length = (points_.row(v) - points_.row(w)).norm();
    return unit_.empty() ? length : 2 * length / (unit_[v] + unit_[w]);
  }

  const Points& points_;
  const IndexLists& rings_;
  SparseChecks check_;
  std::vector<double> distance_;
  std::vector<Index> source_;
  std::vector<Index> new_sources_;
  std::vector<double> unit_;  ///< per vertex; empty: 1
};

}  // namespace

std::vector<Index> farthest_vertices(const Points& points, const IndexLists& rings,
                                     std::span<const std::uint8_t> seeds,
                                     std::span<const std::uint8_t> candidates, Index count,
                                     const Context& context) {
  EdgeDistances distances(points, rings, context);
  const auto start = [&] {
    for (Index v = 0; v < rings.size(); ++v)
      if (seeds[v]) distances.add_source(v, 0);
    distances.update();
  };
  start();
  distances.grade();
  start();
  std::vector<Index> chosen;
  while (true) {
    context.throw_if_stopped();
    Index farthest = -1;
    for (Index v = 0; v < rings.size(); ++v)
      if (candidates[v] && (farthest < 0 || distances.distance(v) > distances.distance(farthest))) farthest = v;
    if (farthest < 0 || !(distances.distance(farthest) > 0)) break;
    const bool reached = distances.distance(farthest) < unreached;
    if (reached && static_cast<Index>(chosen.size()) >= count) break;
    chosen.push_back(farthest);
    distances.add_source(farthest, 0);
    distances.update();
  }
  return chosen;
}

std::vector<Index> nearest_sample(const Points& points, const IndexLists& rings, std::span<const Index> samples,
                                  const Context& context) {
  EdgeDistances distances(points, rings, context);
  for (std::size_t s = 0; s < samples.size(); ++s) distances.add_source(samples[s], static_cast<Index>(s));
  distances.update();
  return distances.sources();
}

}  // namespace meshgraft
