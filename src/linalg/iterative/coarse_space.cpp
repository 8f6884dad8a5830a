#include "coarse_space.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include "affine_bases.h"
#include "core/parallel.h"
#include "core/sparse_checks.h"
#include "four_columns.h"

namespace meshgraft {

namespace {

/// Returns the radius of an aggregate in edges. Entries of the matrix couple nodes up to about four mesh
/// edges apart. Radius two gives a coarse matrix with a twentieth of the unknowns. Its factorisation costs
/// less than the additional sweeps that radius three needs.
int radius_for(const NodeOrder& order) {
  constexpr Index most_for_two = 3'000'000;
  if (!order.has_graph) return 1;
  return order.nodes.count > most_for_two ? 3 : 2;
}

}  // namespace

CoarseSpace::CoarseSpace(const NodeOrder& order, const Context& context) : order_(order) {
  const int radius = radius_for(order);
  const Aggregates aggregates = aggregate(order.neighbours, order.nodes.shared, radius, context);
  blending_ = blend(order.neighbours, aggregates, 2 * radius, context);
  count_ = first_shared_ = aggregates.count;
  context.throw_if_stopped();
  choose_bases(aggregates);
  context.throw_if_stopped();
  add_shared_unknowns();
  context.throw_if_stopped();

  members_.offsets.assign(count_ + 1, 0);
  for (const Index a : blending_.aggregates.values) ++members_.offsets[a + 1];
  std::partial_sum(members_.offsets.begin(), members_.offsets.end(), members_.offsets.begin());
  members_.values.resize(blending_.weight.size());
  member_weight_.resize(blending_.weight.size());
  std::vector<Index> end(members_.offsets.begin(), members_.offsets.end() - 1);
  SparseChecks check(context);
  for (Index node = 0; node < order.nodes.count; ++node, check())
    for (Index k = blending_.aggregates.offsets[node]; k < blending_.aggregates.offsets[node + 1]; ++k) {
      const Index at = end[blending_.aggregates.values[k]]++;
      members_.values[at] = node;
      member_weight_[at] = blending_.weight[k];
    }
}

void CoarseSpace::choose_bases(const Aggregates& aggregates) {
  const BlockRows& nodes = order_.nodes;
  basis_ = affine_bases(aggregates.count, [&](const auto& body) {
    for (std::size_t row = 0; row < nodes.unknown.size(); ++row) {
      const Index a = aggregates.of_node[row / nodes.width];
      if (a >= 0 && nodes.unknown[row] >= 0)
        body(a, Eigen::Vector3d(nodes.positions.row(static_cast<Eigen::Index>(row)).transpose()));
    }
  });
}

void CoarseSpace::add_shared_unknowns() {
  const BlockRows& nodes = order_.nodes;
  column_.assign(nodes.count, 0);
  if (std::find(nodes.shared.begin(), nodes.shared.end(), 1) == nodes.shared.end()) return;
  Blending with_shared;
  Index shared = 0;
  for (Index node = 0; node < nodes.count; ++node) {
    if (is_shared(node)) {
      column_[node] = static_cast<std::uint8_t>(shared % 4);
      with_shared.aggregates.values.push_back(first_shared_ + shared++ / 4);
      with_shared.weight.push_back(1);
    }
    for (Index k = blending_.aggregates.offsets[node]; k < blending_.aggregates.offsets[node + 1]; ++k) {
      with_shared.aggregates.values.push_back(blending_.aggregates.values[k]);
      with_shared.weight.push_back(blending_.weight[k]);
    }
    with_shared.aggregates.offsets.push_back(static_cast<Index>(with_shared.weight.size()));
  }
  blending_ = std::move(with_shared);
  count_ = first_shared_ + (shared + 3) / 4;
  basis_.resize(count_, Basis::Identity());
}

/// Adds the contribution of rows of L + ½D to the blocks (a, b), a ≥ b, of Pᵀ N P = C + Cᵀ, where
/// C = Pᵀ (L + ½D) P.
template <int width>
void CoarseSpace::add_rows(const BlockMatrix& matrix, Index begin, Index end, BlockLists& sums) const {
  using Rows = Eigen::Matrix<double, width, 4>;
  using MatrixBlock = Eigen::Matrix<double, width, width, Eigen::RowMajor>;
  const BlockRows& nodes = order_.nodes;
  std::vector<Index> reached, position(count_, -1);
  std::vector<Rows> product;  // one entry per aggregate reached: row i of L + ½D times (p − p_i, 1) w
  // The functions of a node's rows, about a nearby origin to avoid cancellation.
  const auto functions = [&](Index node, const Eigen::RowVector3d& origin) {
    Rows f = Rows::Zero();
    for (int k = 0; k < width; ++k) {
      const Eigen::Index row = Eigen::Index{width} * node + k;
      if (is_shared(node) && k == 0)
        f(k, column_[node]) = 1;
      else if (nodes.unknown[row] >= 0)
        f.row(k) << nodes.positions.row(row) - origin, 1.0;
    }
    return f;
  };
  // (p, 1) times a basis equals (p − origin, 1) times this.
  const auto basis_about = [&](Index a, const Eigen::RowVector3d& origin) {
    Basis moved = basis_[a];
    if (a < first_shared_) moved.row(3) += origin * basis_[a].template topRows<3>();
    return moved;
  };
  for (Index i = begin; i < end; ++i) {
    const Eigen::RowVector3d origin = nodes.positions.row(Eigen::Index{width} * i);
    const auto add = [&](Index j, const MatrixBlock& block) {
      const Rows of_functions = block * functions(j, origin);
      for (Index k = blending_.aggregates.offsets[j]; k < blending_.aggregates.offsets[j + 1]; ++k) {
        const Index b = blending_.aggregates.values[k];
        if (position[b] < 0) {
          position[b] = static_cast<Index>(reached.size());
          reached.push_back(b);
          product.push_back(Rows::Zero());
        }
        product[position[b]] += blending_.weight[k] * of_functions;
      }
    };
    add(i, 0.5 * Eigen::Map<const MatrixBlock>(matrix.diagonal_block(i)));
    const double* block = matrix.blocks_before(i);
    for (const Index j : order_.before_by_block[i]) {
      add(j, Eigen::Map<const MatrixBlock>(block));
      block += width * width;
    }
    const double* entry = matrix.entries_before(i);
    MatrixBlock first_rows = MatrixBlock::Zero();
    for (const Index j : order_.before_by_entry[i]) {
      first_rows(0, 0) = *entry++;
      add(j, first_rows);
    }
    for (std::size_t k = 0; k < reached.size(); ++k)
      product[k] = (product[k] * basis_about(reached[k], origin)).eval();

    const Rows own = functions(i, origin);
    for (Index k = blending_.aggregates.offsets[i]; k < blending_.aggregates.offsets[i + 1]; ++k) {
      const Index a = blending_.aggregates.values[k];
      const Rows of_a = blending_.weight[k] * own * basis_about(a, origin);
      for (std::size_t l = 0; l < reached.size(); ++l) {
        const Index b = reached[l];
        Block sum = of_a.transpose() * product[l];
        if (a == b) sum += sum.transpose().eval();
        if (a < b) sum.transposeInPlace();
        std::vector<BlockEntry>& row = sums[std::max(a, b)];
        const Index column = std::min(a, b);
        const auto at = std::find_if(row.begin(), row.end(), [&](const auto& e) { return e.column == column; });
        if (at == row.end())
          row.push_back({column, sum});
        else
          at->block += sum;
      }
    }
    for (const Index b : reached) position[b] = -1;
    reached.clear();
    product.clear();
  }
}

NormalMatrix CoarseSpace::restrict_matrix(const BlockMatrix& matrix, const Context& context) const {
  // Each part of the nodes has its own sums, so that the order of summation does not depend on the threads.
  constexpr Index most_parts = 64;
  const Index nodes = order_.nodes.count,
              part_size = std::max<Index>(2048, (nodes + most_parts - 1) / most_parts);
  const std::size_t parts = (nodes + part_size - 1) / part_size;
  std::vector<BlockLists> sums(parts);
  parallel_blocks(
      parts,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
          sums[part].resize(count_);
          const Index first = static_cast<Index>(part) * part_size, last = std::min(nodes, first + part_size);
          if (order_.nodes.width == 1)
            add_rows<1>(matrix, first, last, sums[part]);
          else
            add_rows<2>(matrix, first, last, sums[part]);
        }
      },
      context, 1);

  BlockLists rows(count_);
  std::vector<std::int64_t> entries(count_, 0);  // per column of blocks
  for (Index a = 0; a < count_; ++a) {
    context.throw_if_stopped();
    std::vector<BlockEntry>& row = rows[a];
    for (BlockLists& of_part : sums) {
      row.insert(row.end(), of_part[a].begin(), of_part[a].end());
      std::vector<BlockEntry>().swap(of_part[a]);
    }
    std::stable_sort(row.begin(), row.end(), [](const auto& x, const auto& y) { return x.column < y.column; });
    std::size_t kept = 0;
    for (std::size_t k = 1; k < row.size(); ++k) {
      if (row[k].column == row[kept].column)
        row[kept].block += row[k].block;
      else
        row[++kept] = row[k];
    }
    row.resize(std::min(row.size(), kept + 1));
    for (const BlockEntry& entry : row) ++entries[entry.column];
  }

  sums = {};
  context.throw_if_stopped();

  NormalMatrix coarse(unknowns(), unknowns());
  std::int64_t* offsets = coarse.outerIndexPtr();
  offsets[0] = 0;
  for (Index b = 0; b < count_; ++b)
    for (int k = 0; k < 4; ++k) offsets[4 * b + k + 1] = offsets[4 * b + k] + 4 * entries[b] - k;
  coarse.resizeNonZeros(offsets[unknowns()]);
  std::vector<std::int64_t> end(offsets, offsets + unknowns());
  for (Index a = 0; a < count_; ++a) {
    context.throw_if_stopped();
    for (const auto& [b, block] : rows[a])
      for (int column = 0; column < 4; ++column)
        for (int row = a == b ? column : 0; row < 4; ++row) {
          const std::int64_t at = end[4 * b + column]++;
          coarse.innerIndexPtr()[at] = 4 * std::int64_t{a} + row;
          // In a flat aggregate some coarse unknowns have no function. They couple with nothing and get a
          // unit diagonal.
          const bool idle = a == b && row == column && !(block(row, row) > 0);
          coarse.valuePtr()[at] = idle ? 1.0 : block(row, column);
        }
    std::vector<BlockEntry>().swap(rows[a]);
  }
  return coarse;
}

namespace {

/// Nodes with their weights in aggregates, or the reverse.
struct Weights {
  const Index* begin;
  const Index* others;
  const double* weight;
};

/// Rows of nodes at their positions.
struct NodeRows {
  int width;
  const int* unknown;
  const double* positions;
};

/// Adds up Σ w (p, 1)ᵀ s over the rows of an aggregate's nodes.
MESHGRAFT_WIDEST_REGISTERS void sum_rows(const Weights members, Index aggregate, const NodeRows nodes,
                                         const Four* s, Four (&sum)[4]) {
  Four sums[4] = {};
  for (Index k = members.begin[aggregate]; k < members.begin[aggregate + 1]; ++k) {
    const std::ptrdiff_t first = std::ptrdiff_t{nodes.width} * members.others[k];
    for (std::ptrdiff_t row = first; row < first + nodes.width; ++row) {
      const Four value = members.weight[k] * s[row];
      for (int c = 0; c < 3; ++c) sums[c] += nodes.positions[3 * row + c] * value;
      sums[3] += value;
    }
  }
  for (int c = 0; c < 4; ++c) sum[c] = sums[c];
}

/// Evaluates the blended functions of the aggregates (four rows each) at the rows of nodes [begin, end).
MESHGRAFT_WIDEST_REGISTERS void blend_rows(const Weights aggregates, Index begin, Index end,
                                           const NodeRows nodes, const Four* functions, Four* x) {
  for (Index node = begin; node < end; ++node) {
    Four blended[4] = {};
    for (Index k = aggregates.begin[node]; k < aggregates.begin[node + 1]; ++k)
      for (int c = 0; c < 4; ++c)
        blended[c] += aggregates.weight[k] * functions[4 * std::ptrdiff_t{aggregates.others[k]} + c];
    const std::ptrdiff_t first = std::ptrdiff_t{nodes.width} * node;
    for (std::ptrdiff_t row = first; row < first + nodes.width; ++row) {
      Four value = blended[3];
      for (int c = 0; c < 3; ++c) value += nodes.positions[3 * row + c] * blended[c];
      x[row] = nodes.unknown[row] < 0 ? Four{} : value;
    }
  }
}

}  // namespace

Eigen::MatrixXd CoarseSpace::restrict_columns(const FourColumns& s, Eigen::Index columns,
                                              const Context& context) const {
  const Weights members{members_.offsets.data(), members_.values.data(), member_weight_.data()};
  const NodeRows nodes{order_.nodes.width, order_.nodes.unknown.data(), order_.nodes.positions.data()};
  Eigen::MatrixXd restricted(unknowns(), columns);
  parallel_blocks(
      count_,
      [&](std::size_t begin, std::size_t end) {
        Eigen::Matrix<double, 4, 4, Eigen::RowMajor> sum;
        for (auto a = static_cast<Index>(begin); a < static_cast<Index>(end); ++a) {
          if (a < first_shared_) {
            sum_rows(members, a, nodes, rows_of(s), *reinterpret_cast<Four(*)[4]>(sum.data()));
          } else {
            sum.setZero();
            for (const Index node : members_[a])
              sum.row(column_[node]) += s.row(Eigen::Index{nodes.width} * node);
          }
          restricted.middleRows<4>(4 * Eigen::Index{a}) = (basis_[a].transpose() * sum).leftCols(columns);
        }
      },
      context, 256);
  return restricted;
}

void CoarseSpace::prolong(const Eigen::MatrixXd& y, FourColumns& x, const Context& context) const {
  FourColumns functions = FourColumns::Zero(unknowns(), 4);
  for (Index a = 0; a < count_ && y.cols() > 0; ++a)
    functions.middleRows<4>(4 * Eigen::Index{a}).leftCols(y.cols()) =
        basis_[a] * y.middleRows<4>(4 * Eigen::Index{a});
  x.resize(static_cast<Eigen::Index>(order_.nodes.unknown.size()), 4);
  const Weights aggregates{blending_.aggregates.offsets.data(), blending_.aggregates.values.data(),
                           blending_.weight.data()};
  const NodeRows nodes{order_.nodes.width, order_.nodes.unknown.data(), order_.nodes.positions.data()};
  parallel_blocks(
      order_.nodes.count,
      [&](std::size_t begin, std::size_t end) {
        blend_rows(aggregates, static_cast<Index>(begin), static_cast<Index>(end), nodes, rows_of(functions),
                   rows_of(x));
      },
      context, 2048);
  // The rows of shared nodes are coarse unknowns themselves.
  for (Index a = first_shared_; a < count_; ++a)
    for (const Index node : members_[a]) {
      const Eigen::Index first = Eigen::Index{nodes.width} * node;
      x.middleRows(first, nodes.width).setZero();
      if (nodes.unknown[first] >= 0) x.row(first) = functions.row(4 * Eigen::Index{a} + column_[node]);
    }
}

OrderingGraph CoarseSpace::ordering_graph(const IndexLists& coarse_neighbours) const {
  OrderingGraph graph;
  graph.group.resize(unknowns(), -1);
  for (Index u = 0; u < 4 * first_shared_; ++u) graph.group[u] = u / 4;
  graph.neighbours = &coarse_neighbours;
  return graph;
}

IndexLists CoarseSpace::coarse_neighbours(const Context& context) const {
  IndexLists lists;
  lists.offsets.assign(1, 0);
  std::vector<Index> reached, reached_from(count_, -1);
  for (Index a = 0; a < count_; ++a) {
    context.throw_if_stopped();
    reached.clear();
    for (const Index node : members_[a])
      for (const Index b : blending_.aggregates[node])
        if (b != a && std::exchange(reached_from[b], a) != a) reached.push_back(b);
    std::sort(reached.begin(), reached.end());
    lists.values.insert(lists.values.end(), reached.begin(), reached.end());
    lists.offsets.push_back(static_cast<Index>(lists.values.size()));
  }
  return lists;
}

std::int64_t CoarseSpace::bytes() const {
  return static_cast<std::int64_t>((blending_.weight.size() + member_weight_.size()) *
                                       (sizeof(double) + sizeof(Index)) +
                                   basis_.size() * sizeof(Basis));
}

}  // namespace meshgraft
