#include "linalg/direct/multifrontal.h"

#include <algorithm>

#include <gtest/gtest.h>
#include <Eigen/Cholesky>

#include <meshgraft/core/error.h>

#include "matrix_families.h"
#include "pattern_families.h"

namespace meshgraft {
namespace {

TEST(MultifrontalFactor, InvertsTheMatrixInWhateverOrder) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      MultifrontalFactor factor(pattern);
      factor.factorise(factor.permuted(family.lower, {}), {});
      const Eigen::Index n = family.lower.rows();
      const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n), inverse = factor.solve(identity, {});
      EXPECT_LT((family.lower.selfadjointView<Eigen::Lower>() * inverse - identity).norm(), 1e-9)
          << family.name;
    }
}

TEST(MultifrontalFactor, SolvesTheSameForColumnsAloneAndTogether) {
  for (const NamedMatrix& family : matrix_families()) {
    MultifrontalFactor factor(symbolic_factorisation(family.lower, one_leaf(family.lower.rows()), {}));
    factor.factorise(factor.permuted(family.lower, {}), {});
    const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(family.lower.rows(), 40);
    const Eigen::MatrixXd together = factor.solve(rhs, {});
    EXPECT_EQ(together.cols(), rhs.cols()) << family.name;
    if (rhs.rows() == 0) continue;  // Eigen's blocks of null pointers are undefined
    for (const Eigen::Index column : {0, 31, 32, 39})
      EXPECT_LE((factor.solve(rhs.col(column), {}) - together.col(column)).norm(), 1e-12 * together.norm())
          << family.name;
    EXPECT_EQ(factor.solve(rhs.leftCols(0), {}).cols(), 0) << family.name;
  }
}

// A preconditioner must be symmetric, and positive definite.
TEST(MultifrontalFactor, StaysSymmetricWhenRounded) {
  for (const NamedMatrix& family : matrix_families()) {
    const Eigen::Index n = family.lower.rows();
    MultifrontalFactor factor(symbolic_factorisation(family.lower, one_leaf(n), {}));
    factor.factorise(factor.permuted(family.lower, {}), {});
    const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(n, 3), exact = factor.solve(rhs, {});
    factor.round();
    const Eigen::MatrixXd inverse = factor.solve(Eigen::MatrixXd::Identity(n, n), {});
    EXPECT_LE((inverse - inverse.transpose()).norm(), 1e-12 * inverse.norm()) << family.name;
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(inverse).info(), Eigen::Success) << family.name;
    EXPECT_LE((inverse * rhs - exact).norm(), 1e-3 * exact.norm()) << family.name;
    factor.factorise(factor.permuted(family.lower, {}), {});
    EXPECT_TRUE(same_bytes(factor.solve(rhs, {}), exact)) << family.name;
  }
}

TEST(MultifrontalFactor, IsNotRoundedBeyondTheRangeOfSinglePrecision) {
  for (const NamedMatrix& family : matrix_families())
    for (const double unit : {0x1p-300, 0x1p300}) {
      MultifrontalFactor factor(symbolic_factorisation(family.lower, one_leaf(family.lower.rows()), {}));
      factor.factorise(factor.permuted(unit * family.lower, {}), {});
      const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(family.lower.rows(), 3),
                            exact = factor.solve(rhs, {});
      factor.round();
      EXPECT_TRUE(same_bytes(factor.solve(rhs, {}), exact)) << family.name;
    }
}

TEST(MultifrontalFactor, HasTheSameBytesForAnyNumberOfThreads) {
  for (const Index reach : {1, 2}) {
    const NormalMatrix lower = lattice_matrix(30, 40, reach);
    const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(lower.rows(), 5);
    for (const SupernodalPattern& pattern : patterns_of(lower)) {
      const auto solution = [&](int threads) {
        MultifrontalFactor factor(pattern);
        factor.factorise(factor.permuted(lower, with_threads(threads)), with_threads(threads));
        return factor.solve(rhs, with_threads(threads));
      };
      const Eigen::MatrixXd one = solution(1);
      for (const int threads : {2, 3}) EXPECT_TRUE(same_bytes(solution(threads), one)) << reach;
    }
  }
}

// Powers of four scale the factor by powers of two, which rounds nothing.
TEST(MultifrontalFactor, OfAMatrixFourTimesAsLargeGivesAQuarterOfTheSolution) {
  for (const NamedMatrix& family : matrix_families()) {
    MultifrontalFactor factor(symbolic_factorisation(family.lower, one_leaf(family.lower.rows()), {}));
    const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(family.lower.rows(), 3);
    factor.factorise(factor.permuted(family.lower, {}), {});
    const Eigen::MatrixXd solution = factor.solve(rhs, {});
    factor.factorise(factor.permuted(4.0 * family.lower, {}), {});
    EXPECT_TRUE(same_bytes(Eigen::MatrixXd(4.0 * factor.solve(rhs, {})), solution)) << family.name;
  }
}

/// Returns P N Pᵀ for an elimination order.
Eigen::MatrixXd in_order(const NormalMatrix& lower, const std::vector<int>& order) {
  return full_matrix(lower)(order, order);
}

// A negative entry on the diagonal makes the matrix indefinite. The leading block up to the unknown named is
// the first that is not positive definite.
TEST(MultifrontalFactor, NamesTheUnknownAtWhichTheMatrixIsNotPositiveDefinite) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      const Eigen::Index n = family.lower.rows();
      MultifrontalFactor factor(pattern);
      factor.factorise(factor.permuted(family.lower, {}), {});
      for (Eigen::Index bad = 0; bad < n; bad += 13) {
        NormalMatrix indefinite = family.lower;
        indefinite.coeffRef(bad, bad) *= -1;
        try {
          factor.factorise(factor.permuted(indefinite, {}), {});
          ADD_FAILURE() << "factorised an indefinite matrix: " << family.name;
        } catch (const Error& error) {
          EXPECT_EQ(error.id(), "linalg.not_positive_definite");
          EXPECT_EQ(error.fact().get<std::int64_t>("count"), n);
          const auto named = error.fact().get<std::vector<std::int64_t>>("at");
          ASSERT_EQ(named.size(), 1U);
          const auto before =
              std::find(pattern.order.begin(), pattern.order.end(), named[0]) - pattern.order.begin();
          const Eigen::MatrixXd permuted = in_order(indefinite, pattern.order);
          EXPECT_EQ(permuted.topLeftCorner(before, before).llt().info(), Eigen::Success) << family.name;
          EXPECT_NE(permuted.topLeftCorner(before + 1, before + 1).llt().info(), Eigen::Success) << family.name;
        }
      }
    }
}

TEST(MultifrontalFactor, WorksAgainAfterAMatrixThatIsNotPositiveDefinite) {
  const NormalMatrix lower = lattice_matrix(12, 12, 2);
  const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(lower.rows(), 3);
  for (const SupernodalPattern& pattern : patterns_of(lower)) {
    MultifrontalFactor fresh(pattern), used(pattern);
    fresh.factorise(fresh.permuted(lower, {}), {});
    EXPECT_THROW(used.factorise(used.permuted(-1.0 * lower, {}), {}), Error);
    used.factorise(used.permuted(lower, {}), {});
    EXPECT_TRUE(same_bytes(used.solve(rhs, {}), fresh.solve(rhs, {})));
  }
}

TEST(MultifrontalFactor, CountsAtLeastTheMemoryOfItsEntries) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      MultifrontalFactor factor(pattern);
      factor.factorise(factor.permuted(family.lower, {}), {});
      EXPECT_GE(static_cast<double>(factor.peak_bytes()), 8 * pattern.factor_nonzeros()) << family.name;
    }
}

TEST(MultifrontalFactor, StopsWhenAsked) {
  std::stop_source stop;
  stop.request_stop();
  const Context context{.threads = 1, .progress = {}, .stop_token = stop.get_token()};
  const NormalMatrix lower = lattice_matrix(9, 9);
  MultifrontalFactor factor(symbolic_factorisation(lower, one_leaf(lower.rows()), {}));
  EXPECT_THROW(factor.factorise(factor.permuted(lower, {}), context), Error);
  factor.factorise(factor.permuted(lower, {}), {});
  EXPECT_THROW(factor.solve(Eigen::MatrixXd::Ones(lower.rows(), 1), context), Error);
}

}  // namespace
}  // namespace meshgraft
