#include "block_rows.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include "core/parallel.h"
#include "core/sparse_checks.h"

namespace meshgraft {

namespace {

/// Positions assigned to some nodes. All are cleared at once in constant time.
class NodePositions {
 public:
  explicit NodePositions(Index count) : set_in_(count, 0), position_(set_in_.size(), 0) {}
  void clear() { ++round_; }
  std::size_t find_or_set(Index node, std::size_t position) {
    if (std::exchange(set_in_[node], round_) != round_) position_[node] = position;
    return position_[node];
  }

 private:
  std::vector<std::uint32_t> set_in_;
  std::vector<std::size_t> position_;
  std::uint32_t round_ = 1;
};

/// Makes lists in parallel, where `fill(i, out)` appends to list i. `make_scratch` makes scratch data for
/// each thread.
template <class MakeScratch, class Fill>
IndexLists make_lists(Index count, MakeScratch make_scratch, Fill fill, const Context& context) {
  constexpr Index block_size = 2048;
  const std::size_t blocks = (count + block_size - 1) / block_size;
  std::vector<std::vector<Index>> values(blocks);
  IndexLists lists;
  lists.offsets.assign(count + 1, 0);
  tbb::enumerable_thread_specific<decltype(make_scratch())> scratch(make_scratch);
  parallel_blocks(
      blocks,
      [&](std::size_t begin, std::size_t end) {
        auto& own = scratch.local();
        for (std::size_t block = begin; block < end; ++block) {
          const auto first = static_cast<Index>(block) * block_size;
          for (Index i = first; i < std::min(count, first + block_size); ++i) {
            const std::size_t before = values[block].size();
            fill(i, values[block], own);
            lists.offsets[i + 1] = static_cast<Index>(values[block].size() - before);
          }
        }
      },
      context, 1);
  std::partial_sum(lists.offsets.begin(), lists.offsets.end(), lists.offsets.begin());
  lists.values.reserve(lists.offsets.back());
  for (auto& block : values) {
    context.throw_if_stopped();
    lists.values.insert(lists.values.end(), block.begin(), block.end());
    std::vector<Index>().swap(block);
  }
  return lists;
}

/// A neighbour in the matrix as a number: twice the node, plus one if other entries than that of both nodes'
/// first rows couple the two.
using Coupling = Index;
Coupling coupling(Index node, bool by_block) { return 2 * node + (by_block ? 1 : 0); }
Index node_of(Coupling coupling) { return coupling / 2; }
bool by_block(Coupling coupling) { return coupling % 2 != 0; }

/// Returns the couplings extended so that j has i wherever i has j.
IndexLists symmetric(const IndexLists& half, const Context& context) {
  constexpr unsigned nodes_per_check = 1U << 13;  // each writes to some twenty places that are far apart
  SparseChecks check(context, nodes_per_check);
  IndexLists whole;
  whole.offsets.assign(half.offsets.size(), 0);
  for (Index i = 0; i < half.size(); ++i, check())
    for (const Coupling other : half[i]) {
      ++whole.offsets[i + 1];
      ++whole.offsets[node_of(other) + 1];
    }
  std::partial_sum(whole.offsets.begin(), whole.offsets.end(), whole.offsets.begin());
  whole.values.resize(2 * half.values.size());
  std::vector<Index> end(whole.offsets.begin(), whole.offsets.end() - 1);
  for (Index i = 0; i < half.size(); ++i, check())
    for (const Coupling other : half[i]) {
      whole.values[end[i]++] = other;
      whole.values[end[node_of(other)]++] = coupling(i, by_block(other));
    }
  return whole;
}

BlockRows gather(Index unknowns, const OrderingGraph& graph) {
  const auto group_of = [&](Index u) { return graph.group.empty() ? u : graph.group[u]; };
  Index groups = 0;
  for (Index u = 0; u < unknowns; ++u) groups = std::max(groups, group_of(u) + 1);
  std::vector<std::uint8_t> members(groups, 0);
  BlockRows nodes;
  for (Index u = 0; u < unknowns; ++u)
    if (const Index group = group_of(u); group >= 0 && ++members[group] > 1) nodes.width = 2;

  std::vector<int> open(groups, -1);  // per group: next row of its last node
  nodes.row.resize(unknowns);
  for (Index u = 0; u < unknowns; ++u) {
    const Index group = group_of(u);
    if (group >= 0 && open[group] >= 0 && open[group] % nodes.width != 0) {
      nodes.row[u] = open[group]++;
      continue;
    }
    nodes.row[u] = nodes.width * nodes.count++;
    nodes.shared.push_back(group < 0);
    if (group >= 0) open[group] = nodes.row[u] + 1;
  }
  return nodes;
}

/// Returns the couplings given by the matrix's entries. Two nodes may be coupled twice.
IndexLists matrix_couplings(const NormalMatrix& lower, const BlockRows& nodes, const Context& context) {
  std::vector<std::vector<int>> unknowns(nodes.width);
  for (auto& of_row : unknowns) of_row.assign(nodes.count, -1);
  for (std::size_t u = 0; u < nodes.row.size(); ++u)
    unknowns[nodes.row[u] % nodes.width][nodes.row[u] / nodes.width] = static_cast<int>(u);
  context.throw_if_stopped();
  const IndexLists half = make_lists(
      nodes.count, [&] { return NodePositions(nodes.count); },
      [&](Index node, std::vector<Index>& out, NodePositions& positions) {
        positions.clear();
        for (int at = 0; at < nodes.width; ++at) {
          if (unknowns[at][node] < 0) continue;
          for (NormalMatrix::InnerIterator entry(lower, unknowns[at][node]); entry; ++entry) {
            const int row = nodes.row[entry.row()];
            const Index other = row / nodes.width;
            const bool block = at != 0 || row % nodes.width != 0;
            if (other == node) continue;
            if (const std::size_t position = positions.find_or_set(other, out.size()); position == out.size())
              out.push_back(coupling(other, block));
            else if (block)
              out[position] = coupling(other, true);
          }
        }
      },
      context);
  return symmetric(half, context);
}

/// Breadth-first layers, one connected component after another. Entries couple only nodes of the same or
/// adjacent layers.
struct Layers {
  std::vector<Index> order;     ///< nodes
  std::vector<Index> begin{0};  ///< per layer: its first index in `order`; one more at the end
};

Layers layers_from(const std::vector<Index>& starts, const IndexLists& couplings, const Context& context) {
  SparseChecks check(context);
  Layers layers;
  layers.order.reserve(couplings.size());
  Flags seen(couplings.size(), 0);
  for (const Index start : starts) {
    if (std::exchange(seen[start], 1)) continue;
    layers.order.push_back(start);
    while (layers.begin.back() < static_cast<Index>(layers.order.size())) {
      const auto end = static_cast<Index>(layers.order.size());
      for (Index k = layers.begin.back(); k < end; ++k, check())
        for (const Coupling other : couplings[layers.order[k]])
          if (!std::exchange(seen[node_of(other)], 1)) layers.order.push_back(node_of(other));
      layers.begin.push_back(end);
    }
  }
  return layers;
}

/// Makes layers from a peripheral node of each connected component, so that they are many and small.
Layers long_layers(const IndexLists& couplings, const Context& context) {
  std::vector<Index> starts(couplings.size());
  std::iota(starts.begin(), starts.end(), 0);
  const Layers first = layers_from(starts, couplings, context);
  return layers_from({first.order.rbegin(), first.order.rend()}, couplings, context);
}

/// Makes strips with about the same number of nodes. A strip has at least two layers, so that the odd strips
/// on both sides of an even one do not meet in it.
SweepColouring make_strips(const Layers& layers) {
  constexpr Index most_strips = 64, fewest_nodes = 256, fewest_layers = 2;
  const auto count = static_cast<Index>(layers.order.size());
  const Index enough = std::max(fewest_nodes, (count + most_strips - 1) / most_strips);
  SweepColouring strips;
  Index layers_in = 0;
  for (std::size_t k = 1; k < layers.begin.size(); ++k) {
    ++layers_in;
    if (layers_in < fewest_layers || layers.begin[k] - strips.begin.back() < enough) continue;
    strips.begin.push_back(layers.begin[k]);
    layers_in = 0;
  }
  if (strips.begin.back() == count) return strips;
  if (strips.size() > 0)
    strips.begin.back() = count;
  else
    strips.begin.push_back(count);
  return strips;
}

void renumber(BlockRows& nodes, const std::vector<Index>& number, const OrderingGraph& graph) {
  const auto rows = static_cast<std::size_t>(nodes.count) * nodes.width;
  Flags shared(nodes.shared.size());
  for (std::size_t k = 0; k < number.size(); ++k) shared[number[k]] = nodes.shared[k];
  nodes.shared = std::move(shared);
  nodes.unknown.assign(rows, -1);
  for (std::size_t u = 0; u < nodes.row.size(); ++u) {
    const int row = nodes.row[u];
    nodes.row[u] = nodes.width * number[row / nodes.width] + row % nodes.width;
    nodes.unknown[nodes.row[u]] = static_cast<int>(u);
  }
  nodes.positions = Points::Zero(static_cast<Eigen::Index>(rows), 3);
  if (graph.positions.rows() == 0) return;
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t first = row - row % nodes.width;
    const int unknown = nodes.unknown[nodes.unknown[row] < 0 ? first : row];
    nodes.positions.row(static_cast<Eigen::Index>(row)) = graph.positions.row(unknown);
  }
}

/// Returns for each node, in the new numbering, its couplings that `wanted` accepts. They are in the new
/// numbering too, ascending and distinct.
template <class Wanted>
IndexLists renumbered(const IndexLists& couplings, const std::vector<Index>& order,
                      const std::vector<Index>& number, Wanted wanted, const Context& context) {
  return make_lists(
      static_cast<Index>(order.size()), [] { return 0; },
      [&](Index node, std::vector<Index>& out, int&) {
        const auto start = static_cast<std::ptrdiff_t>(out.size());
        for (const Coupling other : couplings[order[node]])
          if (const Index new_number = number[node_of(other)]; wanted(node, new_number))
            out.push_back(coupling(new_number, by_block(other)));
        std::sort(out.begin() + start, out.end());
        // Keeps the later of two couplings with one node, which is by block if either is.
        auto end = out.begin() + start;
        for (auto it = end; it != out.end(); ++it)
          if (it + 1 == out.end() || node_of(*it) != node_of(it[1])) *end++ = *it;
        out.erase(end, out.end());
      },
      context);
}

/// Returns the nodes of the couplings that `wanted` accepts.
template <class Wanted>
IndexLists nodes_of(const IndexLists& couplings, Wanted wanted, const Context& context) {
  return make_lists(
      couplings.size(), [] { return 0; },
      [&](Index node, std::vector<Index>& out, int&) {
        for (const Coupling other : couplings[node])
          if (wanted(node, other)) out.push_back(node_of(other));
      },
      context);
}

/// Returns for each node those of the same group or of neighbouring groups in the graph.
IndexLists graph_neighbours(const BlockRows& nodes, const OrderingGraph& graph, const Context& context) {
  const Index groups = graph.neighbours->size();
  std::vector<Index> group(nodes.count, -1);
  IndexLists members;
  members.offsets.assign(groups + 1, 0);
  for (Index node = 0; node < nodes.count; ++node) {
    group[node] = graph.group[nodes.unknown[static_cast<std::size_t>(node) * nodes.width]];
    if (group[node] >= 0) ++members.offsets[group[node] + 1];
  }
  std::partial_sum(members.offsets.begin(), members.offsets.end(), members.offsets.begin());
  members.values.resize(members.offsets.back());
  std::vector<Index> end(members.offsets.begin(), members.offsets.end() - 1);
  for (Index node = 0; node < nodes.count; ++node)
    if (group[node] >= 0) members.values[end[group[node]]++] = node;
  return make_lists(
      nodes.count, [] { return 0; },
      [&](Index node, std::vector<Index>& out, int&) {
        if (group[node] < 0) return;
        for (const Index other : members[group[node]])
          if (other != node) out.push_back(other);
        for (const Index beside : (*graph.neighbours)[group[node]])
          out.insert(out.end(), members[beside].begin(), members[beside].end());
      },
      context);
}

/// Without a graph, an unknown that is coupled with very many others is treated like one without a group.
/// Otherwise all its neighbours would count as close to each other.
void share_hubs(const IndexLists& coupled, BlockRows& nodes) {
  constexpr std::size_t few = 64, times_the_mean = 8;
  const std::size_t mean = coupled.values.size() / std::max<Index>(1, nodes.count);
  for (Index node = 0; node < nodes.count; ++node)
    if (coupled[node].size() > few + times_the_mean * mean) nodes.shared[node] = 1;
}

}  // namespace

NodeOrder order_nodes(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context) {
  NodeOrder result;
  BlockRows& nodes = result.nodes;
  nodes = gather(static_cast<Index>(lower.rows()), graph);
  context.throw_if_stopped();
  const IndexLists coupled = matrix_couplings(lower, nodes, context);
  if (graph.neighbours == nullptr) share_hubs(coupled, nodes);
  const Layers layers = long_layers(coupled, context);
  context.throw_if_stopped();
  result.strips = make_strips(layers);
  context.throw_if_stopped();
  std::vector<Index> number(layers.order.size());
  for (std::size_t k = 0; k < layers.order.size(); ++k) number[layers.order[k]] = static_cast<Index>(k);
  context.throw_if_stopped();
  renumber(nodes, number, graph);
  context.throw_if_stopped();

  Flags odd(nodes.count, 0);
  for (Index strip = 1; strip < result.strips.size(); strip += 2)
    std::fill(odd.begin() + result.strips.begin[strip], odd.begin() + result.strips.begin[strip + 1],
              std::uint8_t{1});
  const auto meets_first = [&](Index node, Index other) {
    return odd[other] != odd[node] ? odd[other] < odd[node] : other < node;
  };
  const IndexLists before = renumbered(coupled, layers.order, number, meets_first, context);
  result.before_by_block = nodes_of(before, [](Index, Coupling other) { return by_block(other); }, context);
  result.before_by_entry = nodes_of(before, [](Index, Coupling other) { return !by_block(other); }, context);
  result.has_graph = graph.neighbours != nullptr;
  if (result.has_graph) {
    result.neighbours = graph_neighbours(nodes, graph, context);
  } else {
    const auto both_unshared = [&](Index node, Index other) {
      return !nodes.shared[node] && !nodes.shared[other];
    };
    result.neighbours = nodes_of(
        renumbered(coupled, layers.order, number, both_unshared, context), [](Index, Coupling) { return true; },
        context);
  }
  return result;
}

}  // namespace meshgraft
