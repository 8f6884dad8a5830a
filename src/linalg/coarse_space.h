#pragma once

#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "aggregation.h"
#include "block_matrix.h"
#include "block_rows.h"

namespace meshgraft {

/// The coarse grid of two: one affine function of position per aggregate of nodes, blended from aggregate to
/// aggregate. With w_ia the weight of aggregate a at node i and f_a its function (four numbers, in a basis that
/// is orthonormal over the aggregate), the entry of a row at p is Σ_a w_ia f_a(p): vectors that are affine as a
/// whole are contained, and others are smooth. Unknowns without a group are coarse unknowns themselves.
class CoarseSpace {
 public:
  CoarseSpace(const NodeOrder& order, const Context& context);

  Eigen::Index unknowns() const { return 4 * static_cast<Eigen::Index>(count_); }

  /// Lower triangle of Pᵀ N P, P the matrix from coarse unknowns to rows.
  NormalMatrix restrict_matrix(const BlockMatrix& matrix, const Context& context) const;
  /// Pᵀ s, for the first `columns` of four.
  Eigen::MatrixXd restrict_columns(const FourColumns& s, Eigen::Index columns, const Context& context) const;
  /// P y, zero in columns that y does not have.
  void prolong(const Eigen::MatrixXd& y, FourColumns& x, const Context& context) const;

  /// Where the coarse unknowns sit; `coarse_neighbours` must stay.
  OrderingGraph ordering_graph(const IndexLists& coarse_neighbours) const;
  /// Aggregates that share a node.
  IndexLists coarse_neighbours() const;

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
  Index count_ = 0;  ///< aggregates, and groups of four shared unknowns
  Index first_shared_ = 0;
  Blending blending_;   ///< a shared node belongs to its group alone
  IndexLists members_;  ///< of each aggregate, the nodes that it has a weight at
  std::vector<double> member_weight_;
  std::vector<Basis> basis_;          ///< of functions of (p, 1), columns; zero where the aggregate is flat
  std::vector<std::uint8_t> column_;  ///< of each shared node among its group's four
};

}  // namespace meshgraft
