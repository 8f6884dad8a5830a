#include "symbolic_factorisation.h"

#include <camd.h>

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include "core/parallel.h"
#include "core/sparse_checks.h"

namespace meshgraft {

double SupernodalPattern::factor_nonzeros() const {
  double sum = 0;
  for (int node = 0; node < supernodes(); ++node) {
    const double columns = first_position[node + 1] - first_position[node];
    sum += columns * static_cast<double>(rows_begin[node + 1] - rows_begin[node]) - columns * (columns - 1) / 2;
  }
  return sum;
}

double SupernodalPattern::flops() const {
  double sum = 0;
  for (int node = 0; node < supernodes(); ++node) {
    const double columns = first_position[node + 1] - first_position[node],
                 below = static_cast<double>(rows_begin[node + 1] - rows_begin[node]) - columns;
    sum += columns * (below * below + below * (columns + 1) + (columns + 1) * (2 * columns + 1) / 6);
  }
  return sum;
}

LowerEntries permute(const NormalMatrix& lower, std::span<const int> inverse_permutation, bool with_values,
                     const Context& context) {
  LowerEntries entries;
  const auto count = static_cast<int>(inverse_permutation.size());
  entries.begin.assign(inverse_permutation.size() + 1, 0);
  const auto for_each_entry = [&](const auto& body) {
    share_out(
        count,
        [&](int first, int last) {
          SparseChecks check(context);
          for (Eigen::Index column = 0; column < lower.cols(); ++column, check())
            for (NormalMatrix::InnerIterator it(lower, column); it; ++it) {
              const auto [low, high] = std::minmax(inverse_permutation[it.row()], inverse_permutation[column]);
              if (low >= first && low < last) body(low, high, it.value());
            }
        },
        context);
  };
  for_each_entry([&](int low, int, double) { ++entries.begin[low + 1]; });
  for (int p = 0; p < count; ++p) entries.begin[p + 1] += entries.begin[p];
  entries.row.resize(lower.nonZeros());
  if (with_values) entries.value.resize(entries.row.size());
  std::vector<std::int64_t> next(entries.begin.begin(), entries.begin.end() - 1);
  for_each_entry([&](int low, int high, double value) {
    const std::int64_t entry = next[low]++;
    entries.row[entry] = high;
    if (with_values) entries.value[entry] = value;
  });
  return entries;
}

namespace {

/// Returns for each unknown of a leaf the unknowns of separators with a smaller number that it is coupled
/// with. These are missing from the leaf's own columns of the lower triangle.
std::vector<std::vector<int>> couplings_to_separators(const NormalMatrix& lower, const Dissection& dissection,
                                                      const Context& context) {
  SparseChecks check(context);
  std::vector<std::vector<int>> couplings(lower.cols());
  for (int set = 0; set < dissection.sets(); ++set) {
    if (dissection.is_leaf(set)) continue;
    for (const int column : dissection.unknowns[set]) {
      check();
      for (NormalMatrix::InnerIterator it(lower, column); it; ++it)
        if (dissection.is_leaf(dissection.set_of[it.row()])) couplings[it.row()].push_back(column);
    }
  }
  return couplings;
}

/// Orders a leaf by minimum degree. Unknowns around it add to the degrees but are not eliminated. `local` is
/// all -1 before and after.
void order_leaf(const NormalMatrix& lower, std::vector<int>& leaf,
                const std::vector<std::vector<int>>& couplings, std::vector<int>& local,
                const Context& context) {
  // Data that CAMD owns, so that a cancelled caller can leave it behind.
  struct Camd {
    std::vector<int> begin{0}, rows, constraints, order;
    int status = CAMD_OK;
  };
  const auto camd = std::make_shared<Camd>();
  auto& [begin, rows, constraints, order, status] = *camd;
  std::vector<int> around;
  const auto own = static_cast<int>(leaf.size());
  for (int k = 0; k < own; ++k) local[leaf[k]] = k;
  const auto add = [&](int unknown) {
    if (local[unknown] < 0) {
      local[unknown] = own + static_cast<int>(around.size());
      around.push_back(unknown);
    }
    rows.push_back(local[unknown]);
  };
  for (const int unknown : leaf) {
    for (NormalMatrix::InnerIterator it(lower, unknown); it; ++it)
      if (it.row() != unknown) add(static_cast<int>(it.row()));
    for (const int other : couplings[unknown]) add(other);
    begin.push_back(static_cast<int>(rows.size()));
  }
  const auto count = own + static_cast<int>(around.size());
  for (const int unknown : around) local[unknown] = -1;
  for (const int unknown : leaf) local[unknown] = -1;
  if (rows.empty()) return;  // CAMD rejects an empty graph
  begin.resize(count + 1, begin.back());
  constraints.assign(own, 0);
  constraints.resize(count, 1);
  order.resize(count);
  const auto run = [camd, count] {
    camd->status = camd_order(count, camd->begin.data(), camd->rows.data(), camd->order.data(), nullptr,
                              nullptr, camd->constraints.data());
  };
  constexpr std::size_t many_entries = 100'000;  // some ten milliseconds of work
  if (rows.size() < many_entries)
    run();
  else
    run_abandonable(run, context);
  if (status == CAMD_OUT_OF_MEMORY) throw std::bad_alloc();
  std::vector<int> ordered;
  for (const int k : order)
    if (k < own) ordered.push_back(leaf[k]);
  leaf = std::move(ordered);
}

struct Supernode {
  int first = 0, columns = 0;
  std::vector<int> rows;  ///< positions, ascending, its own first
  double zeros = 0;       ///< explicit zeros that merging stores

  int below() const { return static_cast<int>(rows.size()) - columns; }
  int parent_position() const { return rows[columns]; }
};

/// A set of positions, each with a stamp of when it was added, so that clearing takes constant time.
class StampedSet {
 public:
  explicit StampedSet(std::size_t count) : stamp_(count, 0) {}
  void clear() {
    positions_.clear();
    ++now_;
  }
  void add(int position) {
    if (stamp_[position] == now_) return;
    stamp_[position] = now_;
    positions_.push_back(position);
  }
  std::vector<int>& positions() { return positions_; }

 private:
  std::vector<int> stamp_, positions_;
  int now_ = 0;
};

/// Returns the fundamental supernodes of the positions first … last−1, eliminated one by one. A position
/// joins the preceding supernode if it is that supernode's parent and adds no new row.
std::vector<Supernode> eliminate_one_by_one(int first, int last, const LowerEntries& entries, StampedSet& seen,
                                            const Context& context) {
  std::vector<Supernode> nodes;
  std::vector<std::vector<int>> children(last - first);
  for (int position = first; position < last; ++position) {
    constexpr int between_checks = 1024;
    if (position % between_checks == 0) context.throw_if_stopped();
    const bool follows =
        !nodes.empty() && nodes.back().below() > 0 && nodes.back().parent_position() == position;
    if (!follows) seen.clear();  // else the set holds the rows of the preceding supernode
    seen.add(position);
    const std::size_t known = seen.positions().size();
    for (std::int64_t e = entries.begin[position]; e < entries.begin[position + 1]; ++e)
      seen.add(entries.row[e]);
    for (const int child : children[position - first])
      for (int r = nodes[child].columns; r < static_cast<int>(nodes[child].rows.size()); ++r)
        seen.add(nodes[child].rows[r]);
    if (follows && seen.positions().size() == known) {
      ++nodes.back().columns;
      continue;
    }
    if (!nodes.empty() && !follows && nodes.back().below() > 0 && nodes.back().parent_position() < last)
      children[nodes.back().parent_position() - first].push_back(static_cast<int>(nodes.size()) - 1);
    std::vector<int> rows;
    for (const int row : seen.positions())
      if (row >= position) rows.push_back(row);
    std::sort(rows.begin(), rows.end());
    seen.clear();
    for (const int row : rows) seen.add(row);
    nodes.push_back({position, 1, std::move(rows)});
  }
  return nodes;
}

/// Merges supernodes into the next one if that is their parent and the merge stores few zeros.
std::vector<Supernode> merge(std::vector<Supernode> nodes) {
  std::vector<Supernode> merged;  // in reverse order
  for (auto node = nodes.rbegin(); node != nodes.rend(); ++node) {
    if (!merged.empty() && node->below() > 0) {
      Supernode& next = merged.back();
      const int columns = node->columns + next.columns;
      if (node->parent_position() < next.first + next.columns) {
        const double rows = static_cast<double>(node->columns) + static_cast<double>(next.rows.size());
        const double zeros =
            node->zeros + next.zeros + node->columns * (rows - static_cast<double>(node->rows.size()));
        const double share = zeros / (columns * rows - columns * (columns - 1) / 2.0);
        if (columns <= 8 || (columns <= 24 && share < 0.5) || (columns <= 64 && share < 0.15) || share < 0.05) {
          std::vector<int> all(node->rows.begin(), node->rows.begin() + node->columns);
          all.insert(all.end(), next.rows.begin(), next.rows.end());
          next = {node->first, columns, std::move(all), zeros};
          continue;
        }
      }
    }
    merged.push_back(std::move(*node));
  }
  std::reverse(merged.begin(), merged.end());
  return merged;
}

/// Returns the nodes of a forest in postorder: each subtree is contiguous and ends with its root.
std::vector<int> postorder(const std::vector<int>& parent) {
  const auto count = static_cast<int>(parent.size());
  std::vector<int> last_child(parent.size() + 1, -1), sibling_before(parent.size());
  for (int node = 0; node < count; ++node) {
    const int above = parent[node] < 0 ? count : parent[node];
    sibling_before[node] = std::exchange(last_child[above], node);
  }
  std::vector<int> sequence(parent.size());
  int node = last_child[count];
  for (auto it = sequence.rbegin(); it != sequence.rend(); ++it) {
    *it = node;
    if (last_child[node] >= 0) {
      node = last_child[node];
      continue;
    }
    while (node >= 0 && sibling_before[node] < 0) node = parent[node];
    if (node >= 0) node = sibling_before[node];
  }
  return sequence;
}

/// Returns the first row below each column of the factor, or -1 if there is none (Liu 1990, with compressed
/// paths).
std::vector<int> elimination_tree(const NormalMatrix& lower, const std::vector<int>& order,
                                  const Context& context) {
  // With positions counted from the end, columns of the lower triangle take the role of rows.
  const auto count = static_cast<int>(order.size());
  std::vector<int> backwards(order.size());
  for (int position = 0; position < count; ++position) backwards[order[position]] = count - 1 - position;
  const LowerEntries rows = permute(lower, backwards, false, context);
  std::vector<int> parent(order.size(), -1), ancestor(order.size(), -1);
  SparseChecks check(context);
  for (int position = 0; position < count; ++position) {
    check();
    const int row = count - 1 - position;
    for (std::int64_t e = rows.begin[row]; e < rows.begin[row + 1]; ++e) {
      int node = count - 1 - rows.row[e];
      while (node >= 0 && node < position) {
        const int above = std::exchange(ancestor[node], position);
        if (above < 0) parent[node] = position;
        node = above;
      }
    }
  }
  return parent;
}

/// Returns the supernodes in postorder, in which every subtree is contiguous. Supernodes of one set may have
/// parents at different levels, so they are reordered. Rows stay ascending, because a supernode's rows belong
/// to its ancestors, which keep their order.
SupernodalPattern in_postorder(const std::vector<const Supernode*>& nodes, const std::vector<int>& order,
                               const Context& context) {
  SparseChecks check(context);
  const auto count = static_cast<int>(nodes.size());
  std::vector<int> node_at(order.size()), parent(nodes.size(), -1);
  for (int node = 0; node < count; ++node)
    std::fill_n(node_at.begin() + nodes[node]->first, nodes[node]->columns, node);
  for (int node = 0; node < count; ++node)
    if (nodes[node]->below() > 0) parent[node] = node_at[nodes[node]->parent_position()];
  const std::vector<int> sequence = postorder(parent);

  SupernodalPattern pattern;
  std::vector<int> new_position(order.size());
  for (const int node : sequence) {
    pattern.first_position.push_back(static_cast<int>(pattern.order.size()));
    for (int c = 0; c < nodes[node]->columns; ++c) {
      new_position[nodes[node]->first + c] = static_cast<int>(pattern.order.size());
      pattern.order.push_back(order[nodes[node]->first + c]);
    }
  }
  pattern.first_position.push_back(static_cast<int>(order.size()));
  pattern.rows_begin.push_back(0);
  for (const int node : sequence) {
    check();
    for (const int row : nodes[node]->rows) pattern.rows.push_back(new_position[row]);
    pattern.rows_begin.push_back(static_cast<std::int64_t>(pattern.rows.size()));
  }
  return pattern;
}

}  // namespace

SupernodalPattern symbolic_factorisation(const NormalMatrix& lower, const Dissection& dissection,
                                         const Context& context) {
  const std::size_t count = lower.cols();
  std::vector<std::vector<int>> ordered = dissection.unknowns;
  {
    const std::vector<std::vector<int>> couplings = couplings_to_separators(lower, dissection, context);
    tbb::enumerable_thread_specific<std::vector<int>> locals([&] { return std::vector<int>(count, -1); });
    parallel_blocks(
        ordered.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t set = begin; set < end; ++set)
            if (dissection.is_leaf(static_cast<int>(set)) && !ordered[set].empty())
              order_leaf(lower, ordered[set], couplings, locals.local(), context);
        },
        context, 1);
  }
  std::vector<int> order, inverse_permutation(count), first_of_set;
  for (const std::vector<int>& set : ordered) {
    first_of_set.push_back(static_cast<int>(order.size()));
    for (const int unknown : set) {
      inverse_permutation[unknown] = static_cast<int>(order.size());
      order.push_back(unknown);
    }
  }
  first_of_set.push_back(static_cast<int>(count));
  const LowerEntries entries = permute(lower, inverse_permutation, false, context);

  // Goes up the tree. Each set gets its own supernodes, and the supernodes of descendants whose parent is
  // further up.
  struct Reach {
    int set, node;
  };
  std::vector<std::vector<Supernode>> nodes(ordered.size());
  std::vector<std::vector<Reach>> reaching(ordered.size());
  std::vector<std::vector<int>> children(ordered.size());
  std::vector<double> work;
  for (int set = 0; set < dissection.sets(); ++set) {
    if (dissection.parent[set] >= 0) children[dissection.parent[set]].push_back(set);
    work.push_back(1 + static_cast<double>(ordered[set].size()));
  }
  tbb::enumerable_thread_specific<StampedSet> seen_sets([&] { return StampedSet(count); });
  TaskForest(dissection.parent, work)
      .visit_up(
          [&](int set) {
            const int first = first_of_set[set], last = first_of_set[set + 1];
            StampedSet& seen = seen_sets.local();
            std::vector<Supernode>& own = nodes[set];
            if (dissection.is_leaf(set)) {
              own = merge(eliminate_one_by_one(first, last, entries, seen, context));
            } else {
              seen.clear();
              for (int p = first; p < last; ++p) seen.add(p);
              for (std::int64_t e = entries.begin[first]; e < entries.begin[last]; ++e)
                seen.add(entries.row[e]);
              for (const int child : children[set]) {
                for (const Reach& reach : reaching[child]) {
                  const Supernode& below = nodes[reach.set][reach.node];
                  if (below.parent_position() >= last) {
                    reaching[set].push_back(reach);
                    continue;
                  }
                  for (int r = below.columns; r < static_cast<int>(below.rows.size()); ++r)
                    seen.add(below.rows[r]);
                }
                reaching[child] = {};
              }
              if (first < last) {
                own.push_back({first, last - first, seen.positions()});
                std::sort(own.back().rows.begin(), own.back().rows.end());
              }
            }
            for (std::size_t node = 0; node < own.size(); ++node)
              if (own[node].below() > 0 && own[node].parent_position() >= last)
                reaching[set].push_back({set, static_cast<int>(node)});
          },
          context);

  std::vector<const Supernode*> all;
  for (const std::vector<Supernode>& of_set : nodes)
    for (const Supernode& node : of_set) all.push_back(&node);
  return in_postorder(all, order, context);
}

SupernodalPattern symbolic_factorisation(const NormalMatrix& lower, const std::vector<int>& order,
                                         const Context& context) {
  std::vector<int> in_tree_order = postorder(elimination_tree(lower, order, context)),
                   inverse_permutation(order.size());
  for (int& at : in_tree_order) at = order[at];
  for (std::size_t p = 0; p < order.size(); ++p) inverse_permutation[in_tree_order[p]] = static_cast<int>(p);
  const LowerEntries entries = permute(lower, inverse_permutation, false, context);
  StampedSet seen(order.size());
  const std::vector<Supernode> nodes =
      merge(eliminate_one_by_one(0, static_cast<int>(order.size()), entries, seen, context));
  std::vector<const Supernode*> all;
  for (const Supernode& node : nodes) all.push_back(&node);
  return in_postorder(all, in_tree_order, context);
}

}  // namespace meshgraft
