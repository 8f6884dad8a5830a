#include "linalg/iterative/coarse_space.h"

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>
#include <Eigen/QR>

#include "node_systems.h"

namespace meshgraft {
namespace {

struct CoarseSystem {
  explicit CoarseSystem(NodeSystem of)
      : system(std::move(of)), order(order_nodes(system.lower, system.graph())), space(order, {}) {
    const Eigen::Index unknowns = space.unknowns();
    P.resize(static_cast<Eigen::Index>(order.nodes.unknown.size()), unknowns);
    const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(unknowns, unknowns);
    for (Eigen::Index first = 0; first < unknowns; first += 4) {
      FourColumns x;
      space.prolong(identity.middleCols(first, 4), x, {});
      P.middleCols(first, 4) = x;
    }
  }

  bool is_shared(Eigen::Index row) const { return order.nodes.shared[row / order.nodes.width] != 0; }
  bool is_padding(Eigen::Index row) const { return order.nodes.unknown[row] < 0; }

  NodeSystem system;
  NodeOrder order;
  CoarseSpace space;
  Eigen::MatrixXd P;  ///< the prolongation, column by column
};

/// Returns systems of at most a thousand rows, for dense matrices.
std::vector<std::unique_ptr<CoarseSystem>> coarse_systems() {
  std::vector<std::unique_ptr<CoarseSystem>> systems;
  for (NodeSystem& system : node_systems())
    if (system.lower.rows() <= 1000) systems.push_back(std::make_unique<CoarseSystem>(std::move(system)));
  return systems;
}

/// Returns how far a vector is from the range of P, relative to its length.
double distance_from_range(const Eigen::MatrixXd& P, const Eigen::VectorXd& x) {
  if (x.norm() == 0) return 0;
  const Eigen::VectorXd y = P.completeOrthogonalDecomposition().solve(x);
  return (P * y - x).norm() / x.norm();
}

TEST(CoarseSpace, HasConstants) {
  for (const auto& coarse : coarse_systems()) {
    Eigen::VectorXd constant(coarse->P.rows());
    for (Eigen::Index row = 0; row < constant.size(); ++row)
      constant[row] = coarse->is_padding(row) || coarse->is_shared(row) ? 0 : 1;
    EXPECT_LE(distance_from_range(coarse->P, constant), 1e-10) << coarse->system.name;
  }
}

TEST(CoarseSpace, HasAffineFunctionsOfThePositions) {
  for (const auto& coarse : coarse_systems()) {
    if (!coarse->system.has_graph) continue;
    for (int axis = 0; axis < 3; ++axis) {
      Eigen::VectorXd affine(coarse->P.rows());
      for (Eigen::Index row = 0; row < affine.size(); ++row)
        affine[row] = coarse->is_padding(row) || coarse->is_shared(row)
                          ? 0
                          : 0.7 + coarse->order.nodes.positions(row, axis);
      EXPECT_LE(distance_from_range(coarse->P, affine), 1e-10) << coarse->system.name << ' ' << axis;
    }
  }
}

TEST(CoarseSpace, HasEachSharedUnknownAsOneOfItsOwn) {
  for (const auto& coarse : coarse_systems())
    for (Eigen::Index row = 0; row < coarse->P.rows(); ++row) {
      if (!coarse->is_shared(row) || coarse->is_padding(row)) continue;
      EXPECT_EQ((coarse->P.row(row).array() != 0).count(), 1) << coarse->system.name;
      Eigen::Index column = 0;
      EXPECT_EQ(coarse->P.row(row).maxCoeff(&column), 1) << coarse->system.name;
      EXPECT_EQ((coarse->P.col(column).array() != 0).count(), 1) << coarse->system.name;
    }
}

TEST(CoarseSpace, ProlongsPaddingToZeroAndColumnByColumn) {
  for (const auto& coarse : coarse_systems()) {
    for (const int columns : {0, 1, 3, 4}) {
      const Eigen::MatrixXd y = Eigen::MatrixXd::Random(coarse->space.unknowns(), columns);
      FourColumns x;
      coarse->space.prolong(y, x, {});
      ASSERT_EQ(x.rows(), coarse->P.rows());
      if (x.rows() == 0) continue;  // blocks of an empty matrix have no address
      EXPECT_LE((x.leftCols(columns) - coarse->P * y).norm(), 1e-12 * (1 + x.norm())) << coarse->system.name;
      EXPECT_EQ(x.rightCols(4 - columns).norm(), 0) << coarse->system.name;
      for (Eigen::Index row = 0; row < x.rows(); ++row)
        if (coarse->is_padding(row)) {
          EXPECT_EQ(x.row(row).norm(), 0) << coarse->system.name;
        }
    }
  }
}

TEST(CoarseSpace, RestrictsByTheTransposeOfTheProlongation) {
  for (const auto& coarse : coarse_systems()) {
    FourColumns s = FourColumns::Random(coarse->P.rows(), 4);
    for (Eigen::Index row = 0; row < s.rows(); ++row)
      if (coarse->is_padding(row)) s.row(row).setZero();
    for (const int columns : {1, 3, 4}) {
      const Eigen::MatrixXd expected = coarse->P.transpose() * s.leftCols(columns);
      EXPECT_LE((coarse->space.restrict_columns(s, columns, {}) - expected).norm(),
                1e-11 * (1 + expected.norm()))
          << coarse->system.name;
    }
  }
}

// Coarse unknowns without a function, such as those of flat aggregates, have a unit diagonal.
TEST(CoarseSpace, RestrictsTheMatrixByBothSides) {
  for (const auto& coarse : coarse_systems()) {
    const std::unique_ptr<BlockMatrix> matrix = make_block_matrix(coarse->order);
    matrix->set_values(coarse->system.lower, {});
    const NormalMatrix restricted = coarse->space.restrict_matrix(*matrix, {});
    Eigen::MatrixXd expected =
        coarse->P.transpose() * (matrix_by_rows(coarse->system.lower, coarse->order.nodes) * coarse->P);
    for (Eigen::Index k = 0; k < expected.rows(); ++k)
      if (coarse->P.col(k).norm() == 0) expected(k, k) = 1;
    EXPECT_LE((full_matrix(restricted) - expected).norm(), 1e-10 * expected.norm()) << coarse->system.name;
    for (Eigen::Index column = 0; column < restricted.cols(); ++column)
      for (NormalMatrix::InnerIterator it(restricted, column); it; ++it)
        EXPECT_GE(it.row(), column) << coarse->system.name;
    EXPECT_EQ(full_matrix(restricted).llt().info(), Eigen::Success) << coarse->system.name;
  }
}

TEST(CoarseSpace, KnowsWhichAggregatesShareANode) {
  for (const auto& coarse : coarse_systems()) {
    const IndexLists neighbours = coarse->space.coarse_neighbours();
    const Eigen::Index groups = coarse->space.unknowns() / 4;
    ASSERT_EQ(neighbours.size(), groups) << coarse->system.name;
    Eigen::MatrixXd touches(coarse->P.rows(), groups);
    for (Eigen::Index group = 0; group < groups; ++group)
      touches.col(group) = (coarse->P.middleCols(4 * group, 4).rowwise().norm().array() > 0).cast<double>();
    const Eigen::MatrixXd common = touches.transpose() * touches;
    for (Index a = 0; a < groups; ++a) {
      std::vector<Index> expected;
      for (Index b = 0; b < groups; ++b)
        if (a != b && common(a, b) > 0) expected.push_back(b);
      EXPECT_TRUE(std::ranges::equal(neighbours[a], expected)) << coarse->system.name;
    }
    const OrderingGraph graph = coarse->space.ordering_graph(neighbours);
    ASSERT_EQ(static_cast<Eigen::Index>(graph.group.size()), coarse->space.unknowns()) << coarse->system.name;
    for (Index u = 0; u < static_cast<Index>(graph.group.size()); ++u)
      EXPECT_TRUE(graph.group[u] == u / 4 || graph.group[u] == -1) << coarse->system.name;
  }
}

TEST(CoarseSpace, IsSmallerThanTheSystem) {
  for (const NodeSystem& system : node_systems()) {
    if (!system.has_graph || system.lower.rows() < 100) continue;
    const NodeOrder order = order_nodes(system.lower, system.graph());
    EXPECT_LT(2 * CoarseSpace(order, {}).unknowns(), system.lower.rows() + 8) << system.name;
  }
}

TEST(CoarseSpace, HasTheSameBytesForAnyNumberOfThreads) {
  for (const NodeSystem& system : node_systems()) {
    const NodeOrder order = order_nodes(system.lower, system.graph());
    const std::unique_ptr<BlockMatrix> matrix = make_block_matrix(order);
    matrix->set_values(system.lower, {});
    const FourColumns s = FourColumns::Random(static_cast<Eigen::Index>(order.nodes.unknown.size()), 4);
    struct Results {
      NormalMatrix restricted;
      Eigen::MatrixXd columns;
      FourColumns prolonged;
    };
    const auto results_of = [&](int threads) {
      const Context context = with_threads(threads);
      const CoarseSpace space(order, context);
      Results results{space.restrict_matrix(*matrix, context), space.restrict_columns(s, 4, context), {}};
      space.prolong(results.columns, results.prolonged, context);
      return results;
    };
    const Results one = results_of(1);
    for (const int threads : {2, 3}) {
      const Results several = results_of(threads);
      EXPECT_TRUE(same_bytes(several.restricted, one.restricted)) << system.name;
      EXPECT_TRUE(same_bytes(several.columns, one.columns)) << system.name;
      EXPECT_TRUE(same_bytes(several.prolonged, one.prolonged)) << system.name;
    }
  }
}

}  // namespace
}  // namespace meshgraft
