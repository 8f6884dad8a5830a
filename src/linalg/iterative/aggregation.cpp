#include "aggregation.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "core/parallel.h"
#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

/// A ball around a node, grown layer by layer. `grow` returns false if the ball meets an aggregate, or if a
/// node with very many neighbours makes it far too large.
class Ball {
 public:
  explicit Ball(Index count) : in_ball_of_(count, -1) {}

  bool grow(Index middle, int radius, const IndexLists& neighbours, const std::vector<Index>& taken) {
    constexpr std::size_t most = 200;
    nodes.assign(1, middle);
    in_ball_of_[middle] = middle;
    std::size_t next = 0;
    for (int layer = 0; layer < radius; ++layer)
      for (const std::size_t end = nodes.size(); next < end; ++next)
        for (const Index other : neighbours[nodes[next]]) {
          if (taken[other] >= 0 || nodes.size() > most) return false;
          if (std::exchange(in_ball_of_[other], middle) != middle) nodes.push_back(other);
        }
    return true;
  }

  std::vector<Index> nodes;

 private:
  std::vector<Index> in_ball_of_;
};

/// The memberships of one node. Small ones are dropped.
struct Membership {
  static constexpr std::size_t most = 8;
  std::uint32_t count = 0;
  std::array<Index, most> aggregate{};
  std::array<double, most> weight{};
};

/// Computes the mean over a node and its ring, without entries below a twentieth of it.
class Mean {
 public:
  void clear() { parts_.clear(); }
  void add(const Membership& membership) {
    for (std::uint32_t k = 0; k < membership.count; ++k) {
      auto part = parts_.begin();
      while (part != parts_.end() && part->first != membership.aggregate[k]) ++part;
      if (part == parts_.end())
        parts_.emplace_back(membership.aggregate[k], membership.weight[k]);
      else
        part->second += membership.weight[k];
    }
  }
  Membership largest(double total) {
    constexpr double slight = 0.05;
    std::sort(parts_.begin(), parts_.end(), [](const auto& a, const auto& b) {
      return a.second != b.second ? a.second > b.second : a.first < b.first;
    });
    Membership kept;
    double sum = 0;
    for (const auto& [aggregate, weight] : parts_) {
      if (kept.count == Membership::most || (kept.count > 0 && weight < slight * total)) break;
      kept.aggregate[kept.count] = aggregate;
      kept.weight[kept.count++] = weight;
      sum += weight;
    }
    for (std::uint32_t k = 0; k < kept.count; ++k) kept.weight[k] /= sum;
    return kept;
  }

 private:
  std::vector<std::pair<Index, double>> parts_;
};

}  // namespace

Aggregates aggregate(const IndexLists& neighbours, std::span<const std::uint8_t> left_out, int radius,
                     const Context& context) {
  const Index count = neighbours.size();
  Aggregates result;
  std::vector<Index>& of_node = result.of_node;
  of_node.assign(count, -1);
  context.throw_if_stopped();

  SparseChecks check(context);
  Ball ball(count);
  std::vector<Index> front;
  for (Index node = 0; node < count; ++node) {
    check();
    if (left_out[node] || of_node[node] >= 0 || !ball.grow(node, radius, neighbours, of_node)) continue;
    for (const Index member : ball.nodes) of_node[member] = result.count;
    front.insert(front.end(), ball.nodes.begin(), ball.nodes.end());
    ++result.count;
  }
  context.throw_if_stopped();

  // Adds the nodes between the balls to the nearest aggregate. They are at most a ball's diameter away from
  // one, or farther beyond nodes with very many neighbours.
  for (std::vector<Index> next; !front.empty(); front.swap(next)) {
    next.clear();
    for (const Index node : front) {
      check();
      for (const Index other : neighbours[node])
        if (of_node[other] < 0) {
          of_node[other] = of_node[node];
          next.push_back(other);
        }
    }
  }
  // Groups the connected components that have no room for a ball.
  constexpr std::size_t enough = 50;
  for (Index node = 0; node < count; ++node) {
    if (left_out[node] || of_node[node] >= 0) continue;
    front.assign(1, node);
    of_node[node] = result.count;
    for (std::size_t k = 0; k < front.size() && front.size() < enough; ++k)
      for (const Index other : neighbours[front[k]])
        if (of_node[other] < 0) {
          of_node[other] = result.count;
          front.push_back(other);
        }
    ++result.count;
  }
  return result;
}

Blending blend(const IndexLists& neighbours, const Aggregates& aggregates, int passes, const Context& context) {
  const std::size_t count = neighbours.size();
  std::vector<Membership> members(count), averaged(count);
  context.throw_if_stopped();
  for (std::size_t node = 0; node < count; ++node)
    if (aggregates.of_node[node] >= 0) {
      members[node].count = 1;
      members[node].aggregate[0] = aggregates.of_node[node];
      members[node].weight[0] = 1;
    }
  for (int pass = 0; pass < passes; ++pass) {
    parallel_blocks(
        count,
        [&](std::size_t begin, std::size_t end) {
          Mean mean;
          for (std::size_t node = begin; node < end; ++node) {
            const auto ring = neighbours[static_cast<Index>(node)];
            mean.clear();
            mean.add(members[node]);
            for (const Index other : ring) mean.add(members[other]);
            averaged[node] = mean.largest(1.0 + static_cast<double>(ring.size()));
          }
        },
        context, 2048);
    members.swap(averaged);
  }

  Blending result;
  result.aggregates.offsets.reserve(count + 1);
  SparseChecks check(context);
  for (const Membership& membership : members) {
    check();
    const auto kept = static_cast<std::ptrdiff_t>(membership.count);
    result.aggregates.values.insert(result.aggregates.values.end(), membership.aggregate.begin(),
                                    membership.aggregate.begin() + kept);
    result.weight.insert(result.weight.end(), membership.weight.begin(), membership.weight.begin() + kept);
    result.aggregates.offsets.push_back(static_cast<Index>(result.aggregates.values.size()));
  }
  return result;
}

}  // namespace meshgraft
