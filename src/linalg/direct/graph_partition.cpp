#include "graph_partition.h"

#include <metis.h>

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <numeric>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "linalg/facts.h"

namespace meshgraft {

namespace {

/// The mutex held around every call of METIS. METIS seeds and draws the C library's random numbers, so its
/// results are repeatable only if no other thread draws any.
std::mutex& metis_mutex() {
  static std::mutex mutex;
  return mutex;
}

std::array<idx_t, METIS_NOPTIONS> seeded_options() {
  std::array<idx_t, METIS_NOPTIONS> options{};
  METIS_SetDefaultOptions(options.data());
  options[METIS_OPTION_SEED] = 1;
  return options;
}

}  // namespace

BisectionTree bisect_graph(const OrderingGraph& graph, int levels, const Context& context) {
  const IndexLists& rings = *graph.neighbours;
  struct Input {
    std::vector<idx_t> number, weights, offsets{0}, neighbours, part;
  };
  const auto input = std::make_shared<Input>();
  input->number.assign(rings.size(), -1);
  idx_t vertices = 0;
  for (Index group = 0; group < rings.size(); ++group)
    if (!rings[group].empty()) input->number[group] = vertices++;
  for (const Index group : graph.group)
    if (group >= 0 && input->number[group] < 0) input->number[group] = vertices++;
  input->weights.assign(vertices, 0);
  for (const Index group : graph.group)
    if (group >= 0) ++input->weights[input->number[group]];
  std::vector<Index> group_of(vertices);
  for (Index group = 0; group < rings.size(); ++group)
    if (input->number[group] >= 0) group_of[input->number[group]] = group;
  for (const Index group : group_of) {
    for (const Index other : rings[group]) input->neighbours.push_back(input->number[other]);
    input->offsets.push_back(static_cast<idx_t>(input->neighbours.size()));
  }
  input->part.assign(vertices, 0);
  if (levels > 0)  // METIS rejects a partition into one part
    run_abandonable(
        [input, vertices, levels]() mutable {
          idx_t constraints = 1, parts = idx_t{1} << levels, cut_edges = 0;
          auto options = seeded_options();
          const std::lock_guard lock(metis_mutex());
          const int status = METIS_PartGraphRecursive(
              &vertices, &constraints, input->offsets.data(), input->neighbours.data(), input->weights.data(),
              nullptr, nullptr, &parts, nullptr, nullptr, options.data(), &cut_edges, input->part.data());
          // On failure nothing is cut, and minimum degree orders all unknowns.
          if (status != METIS_OK) std::fill(input->part.begin(), input->part.end(), 0);
        },
        context);
  BisectionTree bisection{levels, std::vector<int>(rings.size(), 0)};
  for (Index group = 0; group < rings.size(); ++group)
    if (input->number[group] >= 0) bisection.part[group] = static_cast<int>(input->part[input->number[group]]);
  return bisection;
}

std::vector<int> nested_dissection_order(const NormalMatrix& lower, const Context& context) {
  if (lower.nonZeros() > std::numeric_limits<idx_t>::max() / 2) throw Error(facts::linalg::MatrixTooLarge{});
  struct Input {
    std::vector<idx_t> offsets, neighbours, order, inverse_permutation;
  };
  const auto input = std::make_shared<Input>();
  const std::size_t count = lower.cols();
  const auto for_each_edge = [&](const auto& body) {
    for (Eigen::Index column = 0; column < lower.cols(); ++column)
      for (NormalMatrix::InnerIterator it(lower, column); it; ++it)
        if (it.row() != column) body(static_cast<idx_t>(column), static_cast<idx_t>(it.row()));
  };
  input->offsets.assign(count + 1, 0);
  for_each_edge([&](idx_t a, idx_t b) {
    ++input->offsets[a + 1];
    ++input->offsets[b + 1];
  });
  std::partial_sum(input->offsets.begin(), input->offsets.end(), input->offsets.begin());
  input->neighbours.resize(input->offsets.back());
  std::vector<idx_t> next(input->offsets.begin(), input->offsets.end() - 1);
  for_each_edge([&](idx_t a, idx_t b) {
    input->neighbours[next[a]++] = b;
    input->neighbours[next[b]++] = a;
  });
  input->order.resize(count);
  std::iota(input->order.begin(), input->order.end(), 0);
  input->inverse_permutation = input->order;
  if (!input->neighbours.empty())  // METIS rejects a graph without edges
    run_abandonable(
        [input] {
          auto vertices = static_cast<idx_t>(input->order.size());
          auto options = seeded_options();
          const std::lock_guard lock(metis_mutex());
          const int status =
              METIS_NodeND(&vertices, input->offsets.data(), input->neighbours.data(), nullptr, options.data(),
                           input->order.data(), input->inverse_permutation.data());
          if (status != METIS_OK) throw std::bad_alloc();
        },
        context);
  return {input->order.begin(), input->order.end()};
}

}  // namespace meshgraft
