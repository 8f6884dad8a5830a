#include "dissection.h"

#include <algorithm>
#include <bit>
#include <numeric>
#include <span>
#include <utility>

#include "bipartite_matching.h"
#include "core/sparse_checks.h"
#include "graph_partition.h"
#include "linalg/backends.h"

namespace meshgraft {

namespace {

/// Returns how many times a matrix with this ordering graph is cut.
int cuts_of(const OrderingGraph& graph) {
  constexpr std::size_t most_in_a_leaf = 500;
  constexpr std::ptrdiff_t fewest_groups_in_a_leaf = 8;
  Flags has_unknowns(graph.neighbours->size(), 0);
  for (const Index group : graph.group)
    if (group >= 0) has_unknowns[group] = 1;
  const auto groups = std::count(has_unknowns.begin(), has_unknowns.end(), 1);
  int levels = 0;
  while ((graph.group.size() >> levels) > most_in_a_leaf && (groups >> levels) > fewest_groups_in_a_leaf)
    ++levels;
  return levels;
}

/// Returns the part of each unknown, or -1 without a group. `levels` is lowered to the number of cuts of the
/// graph if the graph is cut fewer times.
std::vector<int> parts_of_unknowns(const OrderingGraph& graph, int& levels, const Context& context) {
  BisectionTree own;
  BisectionTree& bisection = graph.bisection ? *graph.bisection : own;
  if (bisection.part.empty()) bisection = bisect_graph(graph, levels, context);
  levels = std::min(levels, bisection.levels);
  std::vector<int> part;
  for (const Index group : graph.group)
    part.push_back(group < 0 ? -1 : bisection.part[group] >> (bisection.levels - levels));
  return part;
}

/// An entry of the matrix that crosses a cut.
struct Crossing {
  int left, right;  ///< unknowns
};

/// Returns the fewest unknowns that touch all crossings. `position` is all -1, before and after.
std::vector<int> fewest_touching(std::span<const Crossing> crossings, std::vector<int>& position) {
  std::vector<int> left, right;
  const auto number = [&](int unknown, std::vector<int>& side) {
    if (position[unknown] >= 0) return;
    position[unknown] = static_cast<int>(side.size());
    side.push_back(unknown);
  };
  for (const Crossing& crossing : crossings) {
    number(crossing.left, left);
    number(crossing.right, right);
  }
  BipartiteGraph across;
  across.begin.assign(left.size() + 1, 0);
  across.right_end.resize(crossings.size());
  across.right_count = static_cast<int>(right.size());
  for (const Crossing& crossing : crossings) ++across.begin[position[crossing.left] + 1];
  std::partial_sum(across.begin.begin(), across.begin.end(), across.begin.begin());
  std::vector<int> next(across.begin.begin(), across.begin.end() - 1);
  for (const Crossing& crossing : crossings)
    across.right_end[next[position[crossing.left]]++] = position[crossing.right];
  const VertexCover cover = minimum_vertex_cover(across, maximum_matching(across));
  std::vector<int> touching;
  for (std::size_t k = 0; k < left.size(); ++k)
    if (cover.left[k] != 0) touching.push_back(left[k]);
  for (std::size_t k = 0; k < right.size(); ++k)
    if (cover.right[k] != 0) touching.push_back(right[k]);
  for (const int unknown : left) position[unknown] = -1;
  for (const int unknown : right) position[unknown] = -1;
  return touching;
}

/// Numbers the sets of a full binary tree in postorder. `set` has one entry per level and prefix.
int number_sets(int level, int prefix, std::vector<std::vector<int>>& set, std::vector<int>& parent) {
  int left = -1, right = -1;
  if (level + 1 < static_cast<int>(set.size())) {
    left = number_sets(level + 1, 2 * prefix, set, parent);
    right = number_sets(level + 1, 2 * prefix + 1, set, parent);
  }
  const int number = static_cast<int>(parent.size());
  parent.push_back(-1);
  if (left >= 0) parent[left] = parent[right] = number;
  return set[level][prefix] = number;
}

}  // namespace

bool is_worth_dissecting(const OrderingGraph& graph) {
  constexpr std::size_t fewest_unknowns = 8'000;
  return graph.neighbours != nullptr && graph.group.size() >= fewest_unknowns;
}

void bisect_for_multifrontal(const OrderingGraph& graph, const Context& context) {
  if (is_worth_dissecting(graph) && graph.bisection->part.empty())
    *graph.bisection = bisect_graph(graph, cuts_of(graph), context);
}

Dissection dissect(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context) {
  const std::size_t count = lower.rows();
  int levels = cuts_of(graph);
  const std::vector<int> part = parts_of_unknowns(graph, levels, context);

  // Collects the entries that cross the cuts of each level.
  std::vector<std::vector<Crossing>> crossings(levels);
  SparseChecks check(context);
  for (int column = 0; column < static_cast<int>(count); ++column) {
    check();
    for (NormalMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      const auto row = static_cast<int>(entry.row());
      if (part[row] == part[column] || part[row] < 0 || part[column] < 0) continue;
      const int level = levels - std::bit_width(static_cast<unsigned>(part[row] ^ part[column]));
      const auto [left, right] = part[row] < part[column] ? std::pair(row, column) : std::pair(column, row);
      crossings[level].push_back({left, right});
    }
  }

  // Chooses separators from the first cut on. Unknowns of a separator do not couple the sides of later cuts.
  std::vector<int> level_of(count, levels), position(count, -1);
  for (int level = 0; level < levels; ++level) {
    std::erase_if(crossings[level], [&](const Crossing& crossing) {
      return level_of[crossing.left] < levels || level_of[crossing.right] < levels;
    });
    for (const int unknown : fewest_touching(crossings[level], position)) level_of[unknown] = level;
    context.throw_if_stopped();
  }

  Dissection dissection;
  std::vector<std::vector<int>> set(levels + 1);
  for (int level = 0; level <= levels; ++level) set[level].resize(std::size_t{1} << level);
  const int root = number_sets(0, 0, set, dissection.parent);
  dissection.parent[root] = root + 1;  // set of the unknowns without a group
  dissection.parent.push_back(-1);
  dissection.unknowns.resize(dissection.parent.size());
  dissection.set_of.resize(count);
  for (std::size_t u = 0; u < count; ++u) {
    const int number = part[u] < 0 ? root + 1 : set[level_of[u]][part[u] >> (levels - level_of[u])];
    dissection.set_of[u] = number;
    dissection.unknowns[number].push_back(static_cast<int>(u));
  }
  return dissection;
}

Dissection one_leaf(std::int64_t unknowns) {
  Dissection dissection{{-1}, {std::vector<int>(unknowns)}, {}};
  std::iota(dissection.unknowns[0].begin(), dissection.unknowns[0].end(), 0);
  dissection.set_of.assign(unknowns, 0);
  return dissection;
}

}  // namespace meshgraft
