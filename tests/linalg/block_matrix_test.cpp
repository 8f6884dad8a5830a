#include "linalg/iterative/block_matrix.h"

#include <memory>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <meshgraft/core/error.h>

#include "node_systems.h"

namespace meshgraft {
namespace {

/// A system with its matrix in blocks, and the same matrix as a sparse one with its lower triangle in sweeps'
/// order.
struct BlockSystem {
  explicit BlockSystem(NodeSystem of)
      : system(std::move(of)), order(order_nodes(system.lower, system.graph())) {
    matrix = make_block_matrix(order);
    matrix->set_values(system.lower, {});
    matrix->prepare_sweeps({});
    N = matrix_by_rows(system.lower, order.nodes);
    L_and_D = N;
    const std::vector<Index> sequence = sweep_sequence(order);
    const int width = order.nodes.width;
    L_and_D.prune([&](Eigen::Index row, Eigen::Index column, double) {
      return sequence[column / width] <= sequence[row / width];
    });
  }

  /// Returns four random columns. Padding is zero.
  FourColumns random() const {
    FourColumns x = FourColumns::Random(N.rows(), 4);
    for (Eigen::Index row = 0; row < x.rows(); ++row)
      if (order.nodes.unknown[row] < 0) x.row(row).setZero();
    return x;
  }

  NodeSystem system;
  NodeOrder order;
  std::unique_ptr<BlockMatrix> matrix;
  Eigen::SparseMatrix<double> N, L_and_D;
};

std::vector<std::unique_ptr<BlockSystem>> block_systems() {
  std::vector<std::unique_ptr<BlockSystem>> systems;
  for (NodeSystem& system : node_systems()) systems.push_back(std::make_unique<BlockSystem>(std::move(system)));
  return systems;
}

TEST(BlockMatrix, TimesColumnsIsTheProductOfTheSparseMatrix) {
  for (const auto& system : block_systems()) {
    const FourColumns x = system->random(), expected = system->N * x;
    FourColumns y;
    system->matrix->multiply(x, y, {});
    EXPECT_LE((y - expected).norm(), 1e-13 * expected.norm()) << system->system.name;
  }
}

TEST(BlockMatrix, SweepsForwardBySolvingTheLowerTriangle) {
  for (const auto& system : block_systems()) {
    const FourColumns r = system->random();
    FourColumns z, s;
    system->matrix->sweep_forward(r, z, s, {});
    EXPECT_LE((system->L_and_D * z - r).norm(), single_precision * r.norm()) << system->system.name;
    EXPECT_LE((r - system->N * z - s).norm(), single_precision * r.norm()) << system->system.name;
  }
}

TEST(BlockMatrix, SweepsBackwardBySolvingTheUpperTriangle) {
  for (const auto& system : block_systems()) {
    const FourColumns z = system->random(), e = system->random(), s = system->random();
    FourColumns after = z, overwritten = s;
    system->matrix->sweep_backward(e, overwritten, after, {});
    const FourColumns change = after - z - e, expected = s - FourColumns(system->N * e);
    EXPECT_LE((system->L_and_D.transpose() * change - expected).norm(), single_precision * expected.norm())
        << system->system.name;
  }
}

// A forward sweep and a backward one make a symmetric preconditioner, although L is rounded, and each lowers
// the error in the energy norm.
TEST(BlockMatrix, SweepsForwardAndBackwardSymmetrically) {
  for (const auto& system : block_systems()) {
    const auto swept = [&](const FourColumns& r) {
      FourColumns z, s;
      system->matrix->sweep_forward(r, z, s, {});
      system->matrix->sweep_backward(FourColumns::Zero(r.rows(), 4), s, z, {});
      return z;
    };
    const FourColumns a = system->random(), b = system->random(), of_a = swept(a), of_b = swept(b);
    EXPECT_NEAR(of_a.cwiseProduct(b).sum(), a.cwiseProduct(of_b).sum(), 1e-12 * of_a.norm() * b.norm())
        << system->system.name;
    const auto energy = [&](const FourColumns& x) { return x.cwiseProduct(FourColumns(system->N * x)).sum(); };
    EXPECT_LE(energy(a - swept(system->N * a)), energy(a)) << system->system.name;
  }
}

// Powers of two scale sweeps without rounding, also beyond the range of single precision.
TEST(BlockMatrix, SweepsAlikeInAnyUnit) {
  for (const auto& system : block_systems())
    for (const double unit : {0x1p-200, 0x1p200}) {
      const FourColumns r = system->random();
      FourColumns z, s, z_scaled, s_scaled;
      system->matrix->sweep_forward(r, z, s, {});
      system->matrix->sweep_backward(r, s, z, {});
      system->matrix->set_values(unit * system->system.lower, {});
      system->matrix->prepare_sweeps({});
      system->matrix->sweep_forward(r, z_scaled, s_scaled, {});
      system->matrix->sweep_backward(r / unit, s_scaled, z_scaled, {});
      for (Eigen::Index row = 0; row < r.rows(); ++row)
        if (system->order.nodes.unknown[row] >= 0) {
          EXPECT_LE((unit * z_scaled.row(row) - z.row(row)).norm(), 1e-12 * (1 + z.norm()))
              << system->system.name;
        }
      system->matrix->set_values(system->system.lower, {});
      system->matrix->prepare_sweeps({});
    }
}

TEST(BlockMatrix, HasTheSameBytesForAnyNumberOfThreads) {
  for (const auto& system : block_systems()) {
    const FourColumns x = system->random();
    const auto results_of = [&](int threads) {
      const Context context = with_threads(threads);
      const std::unique_ptr<BlockMatrix> matrix = make_block_matrix(system->order);
      matrix->set_values(system->system.lower, context);
      matrix->prepare_sweeps(context);
      std::vector<FourColumns> results(3);
      matrix->multiply(x, results[0], context);
      matrix->sweep_forward(x, results[1], results[2], context);
      matrix->sweep_backward(x, results[2], results[1], context);
      return results;
    };
    const std::vector<FourColumns> one = results_of(1);
    for (const int threads : {2, 3}) {
      const std::vector<FourColumns> several = results_of(threads);
      for (std::size_t k = 0; k < one.size(); ++k)
        EXPECT_TRUE(same_bytes(several[k], one[k])) << system->system.name;
    }
  }
}

TEST(BlockMatrix, StoresItsBlocksInTheOrderOfTheLists) {
  for (const auto& system : block_systems()) {
    const int width = system->order.nodes.width;
    const Eigen::SparseMatrix<double, Eigen::RowMajor> N = system->N;
    for (Index node = 0; node < system->order.nodes.count; ++node) {
      const auto expect_block = [&](const double* block, Index other) {
        for (int a = 0; a < width; ++a)
          for (int b = 0; b < width; ++b)
            EXPECT_EQ(block[a * width + b], N.coeff(width * node + a, width * other + b))
                << system->system.name;
      };
      expect_block(system->matrix->diagonal_block(node), node);
      const double* block = system->matrix->blocks_before(node);
      for (const Index other : system->order.before_by_block[node]) {
        expect_block(block, other);
        block += width * width;
      }
      const double* entry = system->matrix->entries_before(node);
      for (const Index other : system->order.before_by_entry[node])
        EXPECT_EQ(*entry++, N.coeff(width * node, width * other)) << system->system.name;
    }
  }
}

TEST(BlockMatrix, TakesNewValues) {
  for (const auto& system : block_systems()) {
    const FourColumns x = system->random();
    FourColumns before, after;
    system->matrix->multiply(x, before, {});
    system->matrix->set_values(2.0 * system->system.lower, {});
    system->matrix->multiply(x, after, {});
    for (Eigen::Index row = 0; row < x.rows(); ++row)
      EXPECT_EQ(after.row(row), 2 * before.row(row)) << system->system.name;
  }
}

TEST(BlockMatrix, NamesTheNodeWhoseBlockIsNotPositiveDefinite) {
  for (const auto& system : block_systems())
    for (Eigen::Index bad = 0; bad < system->system.lower.rows(); bad += 101) {
      NormalMatrix indefinite = system->system.lower;
      indefinite.coeffRef(bad, bad) *= -1;
      const BlockRows& nodes = system->order.nodes;
      try {
        system->matrix->set_values(indefinite, {});
        ADD_FAILURE() << "took a block that is not positive definite: " << system->system.name;
      } catch (const Error& error) {
        EXPECT_EQ(error.id(), "linalg.not_positive_definite");
        const auto named = error.fact().get<std::vector<std::int64_t>>("at");
        ASSERT_EQ(named.size(), 1U);
        EXPECT_EQ(nodes.row[named[0]] / nodes.width, nodes.row[bad] / nodes.width) << system->system.name;
      }
    }
}

}  // namespace
}  // namespace meshgraft
