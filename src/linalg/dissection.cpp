#include "dissection.h"

#include <cs.h>
#include <metis.h>

#include <algorithm>
#include <bit>
#include <memory>
#include <new>
#include <span>
#include <utility>

#include <meshgraft/core/parallel.h>

namespace meshgraft {

namespace {

/// Cuts a graph where the fewest edges cross, so that every side has as many unknowns as the other.
GraphCuts cut_graph(const CouplingGraph& graph, int levels, const Context& context) {
  const IndexLists& rings = *graph.neighbours;
  struct Input {
    std::vector<idx_t> number, weights, offsets{0}, neighbours, part;
  };
  const auto input = std::make_shared<Input>();
  input->number.assign(static_cast<std::size_t>(rings.size()), -1);
  idx_t vertices = 0;
  for (Index group = 0; group < rings.size(); ++group)
    if (!rings[group].empty()) input->number[group] = vertices++;
  for (const Index group : graph.group)
    if (group >= 0 && input->number[group] < 0) input->number[group] = vertices++;
  input->weights.assign(static_cast<std::size_t>(vertices), 0);
  for (const Index group : graph.group)
    if (group >= 0) ++input->weights[input->number[group]];
  std::vector<Index> group_of(static_cast<std::size_t>(vertices));
  for (Index group = 0; group < rings.size(); ++group)
    if (input->number[group] >= 0) group_of[input->number[group]] = group;
  for (const Index group : group_of) {
    for (const Index other : rings[group]) input->neighbours.push_back(input->number[other]);
    input->offsets.push_back(static_cast<idx_t>(input->neighbours.size()));
  }
  input->part.assign(static_cast<std::size_t>(vertices), 0);
  if (levels > 0)  // METIS does not take a single part
    run_abandonable(
        [input, vertices, levels]() mutable {
          idx_t constraints = 1, parts = idx_t{1} << levels, cut_edges = 0;
          std::vector<idx_t> options(METIS_NOPTIONS);
          METIS_SetDefaultOptions(options.data());
          options[METIS_OPTION_SEED] = 1;
          const std::lock_guard lock(metis_mutex());
          const int status = METIS_PartGraphRecursive(
              &vertices, &constraints, input->offsets.data(), input->neighbours.data(), input->weights.data(),
              nullptr, nullptr, &parts, nullptr, nullptr, options.data(), &cut_edges, input->part.data());
          // Where nothing is cut, minimum degree is left alone.
          if (status != METIS_OK) std::fill(input->part.begin(), input->part.end(), 0);
        },
        context);
  GraphCuts cuts{levels, std::vector<int>(static_cast<std::size_t>(rings.size()), 0)};
  for (Index group = 0; group < rings.size(); ++group)
    if (input->number[group] >= 0) cuts.part[group] = static_cast<int>(input->part[input->number[group]]);
  return cuts;
}

/// The part of each unknown, at `levels` or, where the graph has been cut fewer times, so many; -1 without a
/// group.
std::vector<int> parts_of_unknowns(const CouplingGraph& graph, int& levels, const Context& context) {
  GraphCuts own;
  GraphCuts& cuts = graph.cuts ? *graph.cuts : own;
  if (cuts.part.empty()) cuts = cut_graph(graph, levels, context);
  levels = std::min(levels, cuts.levels);
  std::vector<int> part;
  for (const Index group : graph.group)
    part.push_back(group < 0 ? -1 : cuts.part[group] >> (cuts.levels - levels));
  return part;
}

/// An entry of the matrix across a cut.
struct Crossing {
  int left, right;  ///< unknowns
};

/// The fewest unknowns that touch all crossings (Koenig's theorem). In the Dulmage-Mendelsohn decomposition of
/// their bipartite graph these are the left unknowns but those of the overdetermined block, and of the right
/// ones those of that block. `place` is all -1, before and after.
std::vector<int> fewest_touching(std::span<const Crossing> crossings, std::vector<int>& place) {
  std::vector<int> left, right;
  const auto number = [&](int unknown, std::vector<int>& side) {
    if (place[unknown] < 0) {
      place[unknown] = static_cast<int>(side.size());
      side.push_back(unknown);
    }
  };
  for (const Crossing& crossing : crossings) {
    number(crossing.left, left);
    number(crossing.right, right);
  }
  std::vector<SuiteSparse_long> offsets(right.size() + 1, 0), rows(crossings.size());
  for (const Crossing& crossing : crossings) ++offsets[static_cast<std::size_t>(place[crossing.right]) + 1];
  for (std::size_t k = 0; k < right.size(); ++k) offsets[k + 1] += offsets[k];
  std::vector<SuiteSparse_long> next(offsets.begin(), offsets.end() - 1);
  for (const Crossing& crossing : crossings) rows[next[place[crossing.right]]++] = place[crossing.left];
  cs_dl across{};
  across.m = static_cast<SuiteSparse_long>(left.size());
  across.n = static_cast<SuiteSparse_long>(right.size());
  across.nzmax = static_cast<SuiteSparse_long>(rows.size());
  across.nz = -1;  // columns are compressed
  across.p = offsets.data();
  across.i = rows.data();
  const std::unique_ptr<cs_dld, decltype(&cs_dl_dfree)> blocks(cs_dl_dmperm(&across, 0), &cs_dl_dfree);
  if (blocks == nullptr) throw std::bad_alloc();
  std::vector<int> touching;
  for (SuiteSparse_long k = 0; k < blocks->rr[2]; ++k) touching.push_back(left[blocks->p[k]]);
  for (SuiteSparse_long k = blocks->cc[3]; k < blocks->cc[4]; ++k) touching.push_back(right[blocks->q[k]]);
  for (const int unknown : left) place[unknown] = -1;
  for (const int unknown : right) place[unknown] = -1;
  return touching;
}

}  // namespace

std::mutex& metis_mutex() {
  static std::mutex mutex;
  return mutex;
}

namespace {

/// Numbers the sets of a full binary tree in postorder; `set` has one entry per level and prefix.
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

Dissection dissect(const NormalMatrix& lower, const CouplingGraph& graph, const Context& context) {
  constexpr std::int64_t most_in_a_leaf = 500, fewest_groups_in_a_leaf = 8;
  const auto count = static_cast<std::size_t>(lower.rows());
  std::vector<std::uint8_t> has_unknowns(static_cast<std::size_t>(graph.neighbours->size()), 0);
  for (const Index group : graph.group)
    if (group >= 0) has_unknowns[group] = 1;
  const std::int64_t groups = std::count(has_unknowns.begin(), has_unknowns.end(), 1);
  int levels = 0;
  while ((lower.rows() >> levels) > most_in_a_leaf && (groups >> levels) > fewest_groups_in_a_leaf) ++levels;
  const std::vector<int> part = parts_of_unknowns(graph, levels, context);

  // The entries across each level's cuts.
  std::vector<std::vector<Crossing>> crossings(static_cast<std::size_t>(levels));
  for (int column = 0; column < static_cast<int>(count); ++column) {
    for (NormalMatrix::InnerIterator entry(lower, column); entry; ++entry) {
      const auto row = static_cast<int>(entry.row());
      if (part[row] == part[column] || part[row] < 0 || part[column] < 0) continue;
      const int level = levels - std::bit_width(static_cast<unsigned>(part[row] ^ part[column]));
      const auto [left, right] = part[row] < part[column] ? std::pair(row, column) : std::pair(column, row);
      crossings[level].push_back({left, right});
    }
  }

  // Separators from the first cut on: what is in one couples no sides of later cuts.
  std::vector<int> level_of(count, levels), place(count, -1);
  for (int level = 0; level < levels; ++level) {
    std::erase_if(crossings[level], [&](const Crossing& crossing) {
      return level_of[crossing.left] < levels || level_of[crossing.right] < levels;
    });
    for (const int unknown : fewest_touching(crossings[level], place)) level_of[unknown] = level;
    context.throw_if_stopped();
  }

  Dissection dissection;
  std::vector<std::vector<int>> set(static_cast<std::size_t>(levels) + 1);
  for (int level = 0; level <= levels; ++level) set[level].resize(std::size_t{1} << level);
  const int root = number_sets(0, 0, set, dissection.parent);
  dissection.parent[root] = root + 1;  // unknowns without a group
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

}  // namespace meshgraft
