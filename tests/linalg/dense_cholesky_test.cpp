#include "linalg/direct/dense_cholesky.h"

#include <functional>
#include <limits>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include "linalg/blas_threads.h"
#include "linalg/direct/narrow_solve.h"
#include "linalg/direct/wide_solve.h"
#include "matrix_families.h"

namespace meshgraft {
namespace {

using Eigen::MatrixXd;

/// A front: a symmetric positive definite matrix of which the first `columns` columns are eliminated.
struct DenseFront {
  MatrixXd matrix;
  int columns = 0;

  int rows() const { return static_cast<int>(matrix.rows()); }
  int below() const { return rows() - columns; }
  std::string name() const { return std::to_string(rows()) + "x" + std::to_string(columns); }
  /// Returns the first columns. Entries above the diagonal are no numbers, so that none may be read.
  MatrixXd panel() const {
    MatrixXd panel = matrix.leftCols(columns);
    panel.triangularView<Eigen::StrictlyUpper>().setConstant(std::numeric_limits<double>::quiet_NaN());
    return panel;
  }
};

DenseFront random_front(int columns, int below, unsigned seed) {
  std::minstd_rand generator(seed);
  const int rows = columns + below;
  DenseFront front{
      MatrixXd::NullaryExpr(rows, rows, [&] { return static_cast<double>(generator() % 2001) / 1000.0 - 1.0; }),
      columns};
  front.matrix = (front.matrix + front.matrix.transpose()).eval();
  front.matrix.diagonal().array() += 2.0 * rows;
  return front;
}

/// Returns fronts of all shapes: fewer and more columns than a strip, a panel and a tile have.
std::vector<DenseFront> front_families() {
  std::vector<DenseFront> fronts;
  unsigned seed = 1;
  for (const int columns : {1, 2, 3, 4, 5, 8, 11, 64, 191, 192, 193, 400})
    for (const int below : {0, 1, 2, 7, 8, 9, 50, 390})
      if (columns + below < 600) fronts.push_back(random_front(columns, below, seed++));
  return fronts;
}

MatrixXd factorised(const DenseFront& front, int threads = 1) {
  MatrixXd panel = front.panel();
  EXPECT_EQ(factorise_panel(panel.data(), front.rows(), front.columns, with_threads(threads)), front.columns)
      << front.name();
  return panel;
}

/// Returns L₁₁ and, below it, L₂₁.
MatrixXd factor_of(const DenseFront& front) {
  MatrixXd factor = factorised(front);
  factor.triangularView<Eigen::StrictlyUpper>().setZero();
  return factor;
}

/// Keeps BLAS on one thread, as the multifrontal factorisation does: it is the caller that uses several.
class DenseCholesky : public testing::Test {
  SingleThreadedBlas single_threaded_{Context{}};
};

TEST_F(DenseCholesky, TimesItsTransposeIsTheMatrix) {
  for (const DenseFront& front : front_families()) {
    const MatrixXd factor = factor_of(front), product = factor * factor.topRows(front.columns).transpose();
    EXPECT_LE((product - front.matrix.leftCols(front.columns)).norm(), 1e-14 * front.matrix.norm())
        << front.name();
    EXPECT_GT(factor.diagonal().minCoeff(), 0) << front.name();
  }
}

TEST_F(DenseCholesky, IsRestoredFromTheFactor) {
  for (const DenseFront& front : front_families())
    for (const int threads : {1, 2}) {
      const MatrixXd panel = factorised(front);
      MatrixXd restored = MatrixXd::Constant(front.rows(), front.columns, 7),
               wanted = front.matrix.leftCols(front.columns);
      wanted.triangularView<Eigen::StrictlyUpper>().setZero();
      restore_panel(panel.data(), front.rows(), front.columns, restored.data(), with_threads(threads));
      EXPECT_LE((restored - wanted).norm(), 1e-14 * front.matrix.norm()) << front.name();
      EXPECT_TRUE(restored.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().isZero(0)) << front.name();

      MatrixXd update = MatrixXd::Zero(front.below(), front.below());
      form_update(panel.data(), front.rows(), front.columns, update.data(), with_threads(threads));
      take_back_update(panel.data(), front.rows(), front.columns, update.data(), with_threads(threads));
      EXPECT_LE(update.triangularView<Eigen::Lower>().toDenseMatrix().norm(), 1e-14 * front.matrix.norm())
          << front.name();
    }
}

TEST_F(DenseCholesky, LeavesTheSchurComplementBelow) {
  for (const DenseFront& front : front_families()) {
    const int below = front.below();
    if (below == 0) continue;
    const MatrixXd panel = factorised(front);
    MatrixXd update = MatrixXd::Constant(below, below, std::numeric_limits<double>::quiet_NaN());
    form_update(panel.data(), front.rows(), front.columns, update.data(), with_threads(1));
    const MatrixXd coupling = front.matrix.bottomLeftCorner(below, front.columns);
    const MatrixXd expected =
        -coupling * front.matrix.topLeftCorner(front.columns, front.columns).llt().solve(coupling.transpose());
    const MatrixXd error = update - expected;
    EXPECT_LE(MatrixXd(error.triangularView<Eigen::Lower>()).norm(), 1e-13 * front.matrix.norm())
        << front.name();
  }
}

using Substitution = std::function<void(const double* panel, int rows, int columns, double* x, int width)>;

/// Checks that the product with the factor takes back what a forward substitution does.
void expect_forward(const Substitution& substitute, std::initializer_list<int> widths) {
  for (const DenseFront& front : front_families()) {
    const MatrixXd panel = factorised(front), factor = factor_of(front);
    for (const int width : widths) {
      const MatrixXd before = MatrixXd::Random(front.rows(), width);
      MatrixXd x = before;
      substitute(panel.data(), front.rows(), front.columns, x.data(), width);
      MatrixXd again = x;
      again.topRows(front.columns).setZero();
      again += factor * x.topRows(front.columns);
      EXPECT_LE((again - before).norm(), 1e-13 * before.norm()) << front.name() << ' ' << width;
    }
  }
}

/// Checks the same of a backward substitution, which keeps the rows below.
void expect_backward(const Substitution& substitute, std::initializer_list<int> widths) {
  for (const DenseFront& front : front_families()) {
    const MatrixXd panel = factorised(front), factor = factor_of(front);
    for (const int width : widths) {
      const MatrixXd before = MatrixXd::Random(front.rows(), width);
      MatrixXd x = before;
      substitute(panel.data(), front.rows(), front.columns, x.data(), width);
      EXPECT_LE((factor.transpose() * x - before.topRows(front.columns)).norm(), 1e-13 * before.norm())
          << front.name() << ' ' << width;
      EXPECT_EQ(x.bottomRows(front.below()), before.bottomRows(front.below())) << front.name() << ' ' << width;
    }
  }
}

/// Runs `test` with each of the processor's sets of instructions.
void for_all_instructions(const std::function<void(platform::VectorInstructions)>& test) {
  using platform::VectorInstructions;
  for (const auto instructions :
       {VectorInstructions::baseline, VectorInstructions::avx2, VectorInstructions::avx512}) {
    if (instructions > platform::vector_instructions()) continue;
    SCOPED_TRACE(static_cast<int>(instructions));
    test(instructions);
  }
}

TEST_F(DenseCholesky, SubstitutesNarrowlyForAnyNumberOfColumns) {
  for_all_instructions([](platform::VectorInstructions instructions) {
    const auto widths = {1, 2, 3, 4, 5, 6, 7, 13, 40};
    expect_forward([&](const double* panel, int rows, int columns, double* x,
                       int width) { solve_narrow_panel(panel, rows, columns, x, width, instructions); },
                   widths);
    expect_backward(
        [&](const double* panel, int rows, int columns, double* x, int width) {
          solve_narrow_panel_transposed(panel, rows, columns, x, width, instructions);
        },
        widths);
  });
}

TEST_F(DenseCholesky, SubstitutesWithARoundedPanelInDoublePrecision) {
  for_all_instructions([](platform::VectorInstructions instructions) {
    for (const DenseFront& front : front_families()) {
      const Eigen::MatrixXf rounded = factorised(front).cast<float>();
      const MatrixXd panel = rounded.cast<double>();
      for (const int width : {1, 3, 4, 7}) {
        const MatrixXd sides = MatrixXd::Random(front.rows(), width);
        const auto solved = [&](const auto& of) {
          MatrixXd x = sides;
          solve_narrow_panel(of.data(), front.rows(), front.columns, x.data(), width, instructions);
          solve_narrow_panel_transposed(of.data(), front.rows(), front.columns, x.data(), width, instructions);
          return x;
        };
        const MatrixXd expected = solved(panel);
        EXPECT_LE((solved(rounded) - expected).norm(), 1e-13 * expected.norm()) << front.name() << ' ' << width;
      }
    }
  });
}

TEST_F(DenseCholesky, SubstitutesWidelyRowByRow) {
  for_all_instructions([](platform::VectorInstructions instructions) {
    using Rows = Eigen::Matrix<double, Eigen::Dynamic, wide_columns, Eigen::RowMajor>;
    const auto row_by_row = [&](const auto& solve) {
      return [&](const double* panel, int rows, int columns, double* x, int width) {
        Eigen::Map<MatrixXd> by_columns(x, rows, width);
        Rows by_rows = by_columns;
        solve(panel, rows, columns, by_rows.data(), instructions);
        by_columns = by_rows;
      };
    };
    expect_forward(row_by_row(solve_wide_panel), {wide_columns});
    expect_backward(row_by_row(solve_wide_panel_transposed), {wide_columns});
  });
}

TEST_F(DenseCholesky, HasTheSameBytesForAnyNumberOfThreads) {
  for (const auto& [columns, below] : {std::pair{20, 900}, {420, 0}, {400, 800}}) {
    const DenseFront front = random_front(columns, below, 5);
    const auto lower_bytes = [](const MatrixXd& x) { return MatrixXd(x.triangularView<Eigen::Lower>()); };
    const auto update_of = [&](int threads) {
      MatrixXd update(below, below);
      form_update(factorised(front).data(), front.rows(), columns, update.data(), with_threads(threads));
      return lower_bytes(update);
    };
    const MatrixXd panel = lower_bytes(factorised(front)), update = update_of(1);
    for (const int threads : {2, 3}) {
      EXPECT_TRUE(same_bytes(lower_bytes(factorised(front, threads)), panel)) << front.name();
      EXPECT_TRUE(same_bytes(update_of(threads), update)) << front.name();
    }
  }
}

// N = L D Lᵀ has the signs of D, and leading blocks are definite up to the first negative entry of D.
TEST_F(DenseCholesky, NamesTheFirstColumnWithoutAPositivePivot) {
  constexpr int columns = 400, below = 9;
  DenseFront front = random_front(columns, below, 6);
  const MatrixXd unit = front.matrix.llt().matrixL();
  for (const int bad : {0, 1, 5, 191, 192, 193, 300, columns - 1}) {
    Eigen::VectorXd signs = Eigen::VectorXd::Ones(front.rows());
    signs[bad] = -1;
    signs[columns - 1] = -1;
    front.matrix = unit * signs.asDiagonal() * unit.transpose();
    MatrixXd panel = front.panel();
    EXPECT_EQ(factorise_panel(panel.data(), front.rows(), columns, with_threads(1)), bad);
  }
}

}  // namespace
}  // namespace meshgraft
