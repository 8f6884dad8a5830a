#include "graph_partition.h"

#include <metis.h>

#include <algorithm>
#include <array>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <numeric>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "core/sparse_checks.h"
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

/// A graph as METIS reads it.
struct Graph {
  std::vector<idx_t> offsets{0}, neighbours;
  std::vector<idx_t> weights;  ///< per vertex; empty: all 1

  idx_t vertices() const { return static_cast<idx_t>(offsets.size()) - 1; }
};

/// Runs a call of METIS that can be left behind. `call` must own everything that it uses. It is left out if a
/// stop is requested before its turn comes.
void run_metis(std::function<void()> call, const Context& context) {
  run_abandonable(
      [call = std::move(call), stop = context.stop_token] {
        const std::lock_guard lock(metis_mutex());
        if (!stop.stop_requested()) call();
      },
      context);
}

/// Returns the graph of the vertices whose `side` is `wanted`, and lists them in `kept`.
Graph subgraph(const Graph& graph, const std::vector<idx_t>& side, idx_t wanted, std::vector<idx_t>& kept,
               const Context& context) {
  SparseChecks check(context);
  std::vector<idx_t> number(graph.vertices(), -1);
  for (idx_t v = 0; v < graph.vertices(); ++v)
    if (side[v] == wanted) {
      number[v] = static_cast<idx_t>(kept.size());
      kept.push_back(v);
    }
  Graph result;
  for (const idx_t v : kept) {
    check();
    for (idx_t e = graph.offsets[v]; e < graph.offsets[v + 1]; ++e)
      if (const idx_t other = number[graph.neighbours[e]]; other >= 0) result.neighbours.push_back(other);
    result.offsets.push_back(static_cast<idx_t>(result.neighbours.size()));
    if (!graph.weights.empty()) result.weights.push_back(graph.weights[v]);
  }
  return result;
}

/// Returns the part of each vertex after one call of METIS, which makes 2^levels parts.
std::vector<idx_t> bisect_at_once(const std::shared_ptr<Graph>& graph, int levels, const Context& context) {
  const auto part = std::make_shared<std::vector<idx_t>>(graph->vertices(), 0);
  if (levels == 0 || graph->neighbours.empty()) return *part;  // METIS rejects a partition into one part
  run_metis(
      [graph, part, levels] {
        idx_t vertices = graph->vertices(), constraints = 1, parts = idx_t{1} << levels, cut_edges = 0;
        auto options = seeded_options();
        const int status = METIS_PartGraphRecursive(
            &vertices, &constraints, graph->offsets.data(), graph->neighbours.data(), graph->weights.data(),
            nullptr, nullptr, &parts, nullptr, nullptr, options.data(), &cut_edges, part->data());
        // On failure nothing is cut, and minimum degree orders all unknowns.
        if (status != METIS_OK) std::fill(part->begin(), part->end(), 0);
      },
      context);
  return std::move(*part);
}

/// Returns the part of each vertex. Large graphs are bisected by one call of METIS per cut, so that each call
/// is short.
std::vector<idx_t> bisect(std::shared_ptr<Graph> graph, int levels, const Context& context) {
  constexpr idx_t most_at_once = 100'000;
  if (levels <= 1 || graph->vertices() <= most_at_once) return bisect_at_once(graph, levels, context);
  std::vector<idx_t> part = bisect_at_once(graph, 1, context);
  std::array<std::vector<idx_t>, 2> kept;
  std::array<std::shared_ptr<Graph>, 2> halves;
  for (const idx_t side : {0, 1})
    halves[side] = std::make_shared<Graph>(subgraph(*graph, part, side, kept[side], context));
  graph.reset();
  for (const idx_t side : {0, 1}) {
    const std::vector<idx_t> below = bisect(std::move(halves[side]), levels - 1, context);
    for (std::size_t k = 0; k < below.size(); ++k) part[kept[side][k]] = (side << (levels - 1)) | below[k];
  }
  return part;
}

/// Returns the vertices in the order of one call of METIS.
std::vector<idx_t> dissect_at_once(const std::shared_ptr<Graph>& graph, const Context& context) {
  struct Result {
    std::vector<idx_t> order, inverse_permutation;
  };
  const auto result = std::make_shared<Result>();
  result->order.resize(graph->vertices());
  std::iota(result->order.begin(), result->order.end(), 0);
  if (graph->neighbours.empty()) return result->order;  // METIS rejects a graph without edges
  result->inverse_permutation = result->order;
  run_metis(
      [graph, result] {
        idx_t vertices = graph->vertices();
        auto options = seeded_options();
        const int status =
            METIS_NodeND(&vertices, graph->offsets.data(), graph->neighbours.data(), nullptr, options.data(),
                         result->order.data(), result->inverse_permutation.data());
        if (status != METIS_OK) throw std::bad_alloc();
      },
      context);
  return std::move(result->order);
}

/// Returns the vertices in the order of a nested dissection. Large graphs are dissected by one call of METIS
/// per separator, so that each call is short.
std::vector<idx_t> nested_dissection(std::shared_ptr<Graph> graph, const Context& context) {
  constexpr std::size_t most_edges_at_once = 4'000'000;
  if (graph->neighbours.size() <= most_edges_at_once) return dissect_at_once(graph, context);
  const auto side = std::make_shared<std::vector<idx_t>>(graph->vertices(), 0);
  run_metis(
      [graph, side] {
        idx_t vertices = graph->vertices(), separator = 0;
        auto options = seeded_options();
        const int status =
            METIS_ComputeVertexSeparator(&vertices, graph->offsets.data(), graph->neighbours.data(), nullptr,
                                         options.data(), &separator, side->data());
        if (status != METIS_OK) throw std::bad_alloc();
      },
      context);
  constexpr idx_t separator = 2;
  std::vector<idx_t> order;
  std::array<std::vector<idx_t>, 2> kept;
  std::array<std::shared_ptr<Graph>, 2> halves;
  for (const idx_t half : {0, 1})
    halves[half] = std::make_shared<Graph>(subgraph(*graph, *side, half, kept[half], context));
  if (kept[0].empty() || kept[1].empty()) return dissect_at_once(graph, context);  // nothing to gain
  graph.reset();
  for (const idx_t half : {0, 1})
    for (const idx_t v : nested_dissection(std::move(halves[half]), context)) order.push_back(kept[half][v]);
  for (idx_t v = 0; v < static_cast<idx_t>(side->size()); ++v)
    if ((*side)[v] == separator) order.push_back(v);
  return order;
}

}  // namespace

BisectionTree bisect_graph(const OrderingGraph& graph, int levels, const Context& context) {
  const IndexLists& rings = *graph.neighbours;
  std::vector<idx_t> number(rings.size(), -1);
  idx_t vertices = 0;
  for (Index group = 0; group < rings.size(); ++group)
    if (!rings[group].empty()) number[group] = vertices++;
  for (const Index group : graph.group)
    if (group >= 0 && number[group] < 0) number[group] = vertices++;
  const auto numbered = std::make_shared<Graph>();
  numbered->weights.assign(vertices, 0);
  for (const Index group : graph.group)
    if (group >= 0) ++numbered->weights[number[group]];
  std::vector<Index> group_of(vertices);
  for (Index group = 0; group < rings.size(); ++group)
    if (number[group] >= 0) group_of[number[group]] = group;
  SparseChecks check(context);
  for (const Index group : group_of) {
    check();
    for (const Index other : rings[group]) numbered->neighbours.push_back(number[other]);
    numbered->offsets.push_back(static_cast<idx_t>(numbered->neighbours.size()));
  }
  const std::vector<idx_t> part = bisect(numbered, levels, context);
  BisectionTree bisection{levels, std::vector<int>(rings.size(), 0)};
  for (Index group = 0; group < rings.size(); ++group)
    if (number[group] >= 0) bisection.part[group] = static_cast<int>(part[number[group]]);
  return bisection;
}

std::vector<int> nested_dissection_order(const NormalMatrix& lower, const Context& context) {
  if (lower.nonZeros() > std::numeric_limits<idx_t>::max() / 2) throw Error(facts::linalg::MatrixTooLarge{});
  const auto graph = std::make_shared<Graph>();
  const std::size_t count = lower.cols();
  const auto for_each_edge = [&](const auto& body) {
    SparseChecks check(context);
    for (Eigen::Index column = 0; column < lower.cols(); ++column) {
      check();
      for (NormalMatrix::InnerIterator it(lower, column); it; ++it)
        if (it.row() != column) body(static_cast<idx_t>(column), static_cast<idx_t>(it.row()));
    }
  };
  graph->offsets.assign(count + 1, 0);
  for_each_edge([&](idx_t a, idx_t b) {
    ++graph->offsets[a + 1];
    ++graph->offsets[b + 1];
  });
  std::partial_sum(graph->offsets.begin(), graph->offsets.end(), graph->offsets.begin());
  graph->neighbours.resize(graph->offsets.back());
  std::vector<idx_t> next(graph->offsets.begin(), graph->offsets.end() - 1);
  for_each_edge([&](idx_t a, idx_t b) {
    graph->neighbours[next[a]++] = b;
    graph->neighbours[next[b]++] = a;
  });
  const std::vector<idx_t> order = nested_dissection(graph, context);
  return {order.begin(), order.end()};
}

}  // namespace meshgraft
