#include "skin.h"

#include <algorithm>
#include <cmath>

#include <tbb/enumerable_thread_specific.h>

#include "core/parallel.h"
#include "deform/setup/ball_walk.h"

namespace meshgraft {

namespace {

/// Returns a weight that is 1 at 0 and 0 from 1 on, with zero slope at both. `squared` is the square of the
/// argument.
double fall_off(double squared) {
  const double rest = std::max(0.0, 1 - squared);
  return rest * rest;
}

/// An effect of one source on one vertex: a weight or a squared distance.
struct Hit {
  Index other;
  float value;
};
using Hits = std::vector<std::vector<Hit>>;  // per source, in the order of the walk

/// Lists per vertex instead of per source. Sources ascend in each list.
struct HitLists {
  std::vector<std::int64_t> offsets;
  std::vector<Hit> hits;
  std::span<const Hit> operator[](Index v) const {
    return {hits.data() + offsets[v], static_cast<std::size_t>(offsets[v + 1] - offsets[v])};
  }
};

HitLists by_vertex(Hits per_source, Index vertex_count) {
  HitLists lists;
  lists.offsets.assign(static_cast<std::size_t>(vertex_count) + 1, 0);
  for (const auto& hits : per_source)
    for (const Hit& hit : hits) ++lists.offsets[hit.other + 1];
  for (Index v = 0; v < vertex_count; ++v) lists.offsets[v + 1] += lists.offsets[v];
  std::vector<std::int64_t> next(lists.offsets.begin(), lists.offsets.end() - 1);
  lists.hits.resize(lists.offsets.back());
  for (std::size_t k = 0; k < per_source.size(); ++k) {
    for (const Hit& hit : per_source[k]) lists.hits[next[hit.other]++] = {static_cast<Index>(k), hit.value};
    per_source[k] = {};
  }
  return lists;
}

class SkinMaker {
 public:
  SkinMaker(SkinProblem problem, const Context& context) : problem_(std::move(problem)), context_(context) {
    wanted_.assign(problem_.points.rows(), 0);
    for (const Index v : problem_.rows) wanted_[v] = 1;
    for (const Index v : problem_.inner) wanted_[v] = 1;
  }

  SkinResult make() {
    SkinResult result;
    const HitLists proxies = influence_all(result.outside);
    if (!result.outside.empty()) return result;
    const HitLists boundary = walk_from_boundaries();
    result.skin = write_rows(proxies, boundary);
    return result;
  }

 private:
  /// Returns the weights of the proxies. Their radii grow until every row has a weight.
  HitLists influence_all(std::vector<Index>& outside) {
    Hits hits(problem_.proxies.size());
    std::vector<Index> changed(hits.size());
    for (std::size_t k = 0; k < changed.size(); ++k) changed[k] = static_cast<Index>(k);
    while (!changed.empty()) {
      walk(changed, hits);
      changed = extend(hits, outside);
      if (!outside.empty()) return {};
    }
    return by_vertex(std::move(hits), static_cast<Index>(problem_.points.rows()));
  }

  void walk(std::span<const Index> sources, Hits& hits) {
    tbb::enumerable_thread_specific<BallWalk> walks([&] { return BallWalk(problem_.points, problem_.rings); });
    parallel_blocks(
        sources.size(),
        [&](std::size_t begin, std::size_t end) {
          BallWalk& ball = walks.local();
          for (std::size_t s = begin; s < end; ++s) {
            const Index k = sources[s];
            hits[k].clear();
            const double radius = problem_.radius[k];
            ball.from(problem_.proxies[k], radius, [&](Index v, double squared) {
              if (!wanted_[v]) return;
              const auto weight = static_cast<float>(radius > 0 ? fall_off(squared / (radius * radius)) : 1.0);
              if (weight > 0) hits[k].push_back({v, weight});
            });
          }
        },
        context_, 32);
  }

  /// Extends the nearest proxy's influence radius to each vertex that no proxy influences. Returns these
  /// proxies, ascending.
  std::vector<Index> extend(const Hits& hits, std::vector<Index>& outside) {
    Flags influenced(wanted_.size(), 0);
    for (const auto& list : hits)
      for (const Hit& hit : list) influenced[hit.other] = 1;
    std::vector<Index> lost;
    for (std::size_t v = 0; v < wanted_.size(); ++v)
      if (wanted_[v] && !influenced[v]) lost.push_back(static_cast<Index>(v));
    if (lost.empty()) return {};

    // Finds the proxy that is the fewest edges away.
    std::vector<Index> nearest(wanted_.size(), -1), queue;
    for (std::size_t k = 0; k < problem_.proxies.size(); ++k) {
      nearest[problem_.proxies[k]] = static_cast<Index>(k);
      queue.push_back(problem_.proxies[k]);
    }
    for (std::size_t next = 0; next < queue.size(); ++next)
      for (const Index w : problem_.rings[queue[next]])
        if (nearest[w] < 0) {
          nearest[w] = nearest[queue[next]];
          queue.push_back(w);
        }
    std::vector<Index> extended;
    for (const Index v : lost) {
      const Index k = nearest[v];
      if (k < 0) {
        outside.push_back(v);
        continue;
      }
      const double distance = (problem_.points.row(v) - problem_.points.row(problem_.proxies[k])).norm();
      // The path to the vertex may leave the ball. In that case the next call extends the radius again.
      problem_.radius[k] = 1.5 * std::max(distance, problem_.radius[k]);
      extended.push_back(k);
    }
    std::sort(extended.begin(), extended.end());
    extended.erase(std::unique(extended.begin(), extended.end()), extended.end());
    return extended;
  }

  /// Returns squared distances to the boundaries' vertices.
  HitLists walk_from_boundaries() {
    Hits hits(problem_.boundary.size());
    tbb::enumerable_thread_specific<BallWalk> walks([&] { return BallWalk(problem_.points, problem_.rings); });
    parallel_blocks(
        hits.size(),
        [&](std::size_t begin, std::size_t end) {
          BallWalk& ball = walks.local();
          for (std::size_t r = begin; r < end; ++r)
            ball.from(problem_.boundary[r].vertex, problem_.boundary_radius, [&](Index v, double squared) {
              if (wanted_[v]) hits[r].push_back({v, static_cast<float>(squared)});
            });
        },
        context_, 32);
    return by_vertex(std::move(hits), static_cast<Index>(problem_.points.rows()));
  }

  struct Entry {
    Index bone;
    double weight;
  };

  void follow_proxies(std::span<const Hit> hits, double share, std::vector<Entry>& row) const {
    double sum = 0;
    for (const Hit& hit : hits) sum += hit.value;
    for (const Hit& hit : hits) row.push_back({hit.other, share * hit.value / sum});
  }

  /// Adds the boundary vertices within twice the distance of the nearest one. Close to the boundary these are
  /// few, and at the boundary only the nearest one.
  void follow_rim(std::span<const Hit> hits, double squared_distance, double share,
                  std::vector<Entry>& row) const {
    double sum = 0;
    const auto weight = [&](const Hit& hit) { return fall_off(hit.value / (4 * squared_distance)); };
    for (const Hit& hit : hits) sum += weight(hit);
    for (const Hit& hit : hits)
      if (weight(hit) > 0) row.push_back({problem_.boundary[hit.other].bone, share * weight(hit) / sum});
  }

  /// Merges entries of the same bone and puts the heaviest bone first.
  static void tidy(std::vector<Entry>& row) {
    std::sort(row.begin(), row.end(), [](const Entry& a, const Entry& b) { return a.bone < b.bone; });
    std::size_t kept = 0;
    for (const Entry& entry : row) {
      if (kept > 0 && row[kept - 1].bone == entry.bone)
        row[kept - 1].weight += entry.weight;
      else
        row[kept++] = entry;
    }
    row.resize(kept);
    const auto heaviest = std::max_element(row.begin(), row.end(),
                                           [](const Entry& a, const Entry& b) { return a.weight < b.weight; });
    std::rotate(row.begin(), heaviest, heaviest + 1);
  }

  std::vector<Entry> row_of(Index v, bool by_boundary, const HitLists& proxies,
                            const HitLists& boundary) const {
    std::vector<Entry> row;
    const std::span<const Hit> near = proxies[v], sources = by_boundary ? boundary[v] : std::span<const Hit>();
    double share = 0;
    const bool alone = near.size() == 1 && problem_.proxies[near.front().other] == v;
    if (!sources.empty() && !alone) {
      const float nearest = std::min_element(sources.begin(), sources.end(), [](const Hit& a, const Hit& b) {
                              return a.value < b.value;
                            })->value;
      share = fall_off(nearest / (problem_.boundary_radius * problem_.boundary_radius));
      if (nearest > 0)
        follow_rim(sources, nearest, share, row);
      else
        share = 0;  // another vertex at the same position: it is not the boundary's
    }
    follow_proxies(near, 1 - share, row);
    tidy(row);
    return row;
  }

  Skin write_rows(const HitLists& proxies, const HitLists& boundary) {
    // Blocks of rows are written independently, then concatenated.
    constexpr std::size_t block_rows = 4096;
    const std::size_t outer = problem_.rows.size(), count = outer + problem_.inner.size();
    struct Block {
      std::vector<Index> bones, sizes;
      std::vector<float> weights;
    };
    std::vector<Block> blocks((count + block_rows - 1) / block_rows);
    parallel_blocks(
        blocks.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t b = begin; b < end; ++b)
            for (std::size_t r = b * block_rows; r < std::min(count, (b + 1) * block_rows); ++r) {
              const bool by_boundary = r < outer;
              const auto row = row_of(by_boundary ? problem_.rows[r] : problem_.inner[r - outer], by_boundary,
                                      proxies, boundary);
              for (const Entry& entry : row) {
                blocks[b].bones.push_back(entry.bone);
                blocks[b].weights.push_back(static_cast<float>(entry.weight));
              }
              blocks[b].sizes.push_back(static_cast<Index>(row.size()));
            }
        },
        context_, 1);
    Skin skin;
    skin.offsets.reserve(count + 1);
    std::size_t entries = 0;
    for (const Block& block : blocks) entries += block.bones.size();
    skin.bones.reserve(entries);
    skin.weights.reserve(entries);
    for (Block& block : blocks) {
      for (const Index size : block.sizes) skin.offsets.push_back(skin.offsets.back() + size);
      skin.bones.insert(skin.bones.end(), block.bones.begin(), block.bones.end());
      skin.weights.insert(skin.weights.end(), block.weights.begin(), block.weights.end());
      block = {};
    }
    return skin;
  }

  SkinProblem problem_;
  const Context& context_;
  Flags wanted_;
};

}  // namespace

Bone blend(const Skin& skin, Index row, std::span<const Bone> bones) {
  const std::int64_t begin = skin.offsets[row], end = skin.offsets[row + 1];
  const Bone& first = bones[skin.bones[begin]];
  Bone sum = first;
  for (std::int64_t e = begin + 1; e < end; ++e)
    sum += static_cast<double>(skin.weights[e]) * (bones[skin.bones[e]] - first);
  return sum;
}

SkinResult make_skin(SkinProblem problem, const Context& context) {
  return SkinMaker(std::move(problem), context).make();
}

}  // namespace meshgraft
