#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "aggregation.h"
#include "block_matrix.h"
#include "block_rows.h"

namespace meshgraft {

/// The coarse grid of a two-grid method: one affine function of position per aggregate of nodes, blended
/// between aggregates. Let w_ia be the weight of aggregate a at node i. Let f_a be the aggregate's function
/// (four numbers, in a basis that is orthonormal over the aggregate). The entry of a row at p is then
/// Σ_a w_ia f_a(p). The space contains vectors that are globally affine, and its other vectors are smooth.
/// Unknowns without a group are coarse unknowns themselves.
class CoarseSpace {
 public:
  CoarseSpace(const NodeOrder& order, const Context& context);

  Eigen::Index unknowns() const { return 4 * static_cast<Eigen::Index>(count_); }

  /// Returns the lower triangle of Pᵀ N P, where P is the matrix from coarse unknowns to rows.
  NormalMatrix restrict_matrix(const BlockMatrix& matrix, const Context& context) const;
  /// Returns Pᵀ s for the first `columns` of the four columns.
  Eigen::MatrixXd restrict_columns(const FourColumns& s, Eigen::Index columns, const Context& context) const;
  /// Computes x = P y. Columns that y does not have are zero.
  void prolong(const Eigen::MatrixXd& y, FourColumns& x, const Context& context) const;

  /// Returns the ordering graph of the coarse unknowns. `coarse_neighbours` must outlive it.
  OrderingGraph ordering_graph(const IndexLists& coarse_neighbours) const;
  /// Returns for each aggregate those that share a node with it.
  IndexLists coarse_neighbours(const Context& context = {}) const;

  std::int64_t bytes() const;

 private:
  using Basis = Eigen::Matrix4d;
  using Block = Eigen::Matrix4d;
  struct BlockEntry {
    Index column;
    Block block;
  };
  using BlockLists = std::vector<std::vector<BlockEntry>>;  // per aggregate

  void choose_bases(const Aggregates& aggregates);
  void add_shared_unknowns();
  template <int width>
  void add_rows(const BlockMatrix& matrix, Index begin, Index end, BlockLists& sums) const;

  bool is_shared(Index node) const { return order_.nodes.shared[node] != 0; }

  const NodeOrder& order_;
  Index count_ = 0;  ///< number of aggregates plus groups of four shared unknowns
  Index first_shared_ = 0;
  Blending blending_;   ///< a shared node belongs to its group only
  IndexLists members_;  ///< per aggregate: the nodes at which it has a weight
  std::vector<double> member_weight_;
  std::vector<Basis> basis_;          ///< columns are functions of (p, 1); zero where the aggregate is flat
  std::vector<std::uint8_t> column_;  ///< per shared node: its index in its group of four
};

}  // namespace meshgraft
