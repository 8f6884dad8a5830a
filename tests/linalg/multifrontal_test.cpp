#include "linalg/direct/multifrontal.h"

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

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

/// Removes some unknowns of a matrix, and raises the diagonal of others.
struct ChangedMatrix {
  NormalMatrix lower;
  MatrixChange change;

  ChangedMatrix(const NormalMatrix& before, const std::vector<int>& removed, const std::vector<int>& raised)
      : change{.difference = NormalMatrix(before.rows(), before.cols()),
               .number = std::vector<int>(before.rows(), 0)} {
    for (const int u : removed) change.number[u] = -1;
    int next = 0;
    for (int& number : change.number)
      if (number == 0) number = next++;
    std::vector<Eigen::Triplet<double>> entries, differences;
    for (Eigen::Index column = 0; column < before.cols(); ++column)
      for (NormalMatrix::InnerIterator it(before, column); it; ++it) {
        const auto row = static_cast<int>(it.row()), c = static_cast<int>(column);
        const bool is_raised = row == c && std::find(raised.begin(), raised.end(), c) != raised.end();
        if (change.number[row] >= 0 && change.number[c] >= 0) {
          entries.emplace_back(change.number[row], change.number[c], (is_raised ? 1.5 : 1) * it.value());
          if (is_raised) differences.emplace_back(row, c, 0.5 * it.value());
        } else {
          differences.emplace_back(row, c, row == c ? 0 : -it.value());
        }
      }
    lower.resize(next, next);
    lower.setFromTriplets(entries.begin(), entries.end());
    change.difference.setFromTriplets(differences.begin(), differences.end());
  }
};

/// Returns the largest entry of N X − I, where X are the solutions for the unit vectors.
double inversion_error(const NormalMatrix& lower, const MultifrontalFactor& factor, int threads = 0) {
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(lower.rows(), lower.rows()),
                        inverse = factor.solve(identity, with_threads(threads));
  return (full_matrix(lower) * inverse - identity).cwiseAbs().maxCoeff();
}

TEST(MultifrontalFactor, OfAChangedMatrixSharesAndInverts) {
  for (const Index reach : {1, 2}) {
    const NormalMatrix lower = lattice_matrix(24, 24, reach);
    int changed = 0, changed_twice = 0;
    for (const SupernodalPattern& pattern : patterns_of(lower)) {
      MultifrontalFactor factor(pattern);
      factor.factorise(factor.permuted(lower, {}), {});
      const Eigen::MatrixXd before = factor.solve(Eigen::MatrixXd::Ones(lower.rows(), 1), {});
      for (const auto& [removed, raised] : std::vector<std::pair<std::vector<int>, std::vector<int>>>{
               {{50}, {}}, {{50, 51, 74}, {52, 75}}, {{}, {0}}, {{500, 501}, {502}}}) {
        const ChangedMatrix once(lower, removed, raised);
        const auto first = factor.changed(once.change, {});
        if (!first) continue;
        ++changed;
        EXPECT_LT(inversion_error(once.lower, *first), 1e-12);
        EXPECT_LT(first->peak_bytes(), factor.peak_bytes());
        const ChangedMatrix twice(once.lower, {2, 3, 27}, {4});
        const auto second = first->changed(twice.change, {}),
                   again = first->changed(twice.change, with_threads(1));
        if (second) {
          ++changed_twice;
          EXPECT_LT(inversion_error(twice.lower, *second), 1e-12);
          const Eigen::MatrixXd rhs = Eigen::MatrixXd::Random(twice.lower.rows(), 20);
          EXPECT_TRUE(same_bytes(second->solve(rhs, {}), again->solve(rhs, with_threads(1))));
        }
        EXPECT_LT(inversion_error(once.lower, *first), 1e-12);  // as before
      }
      EXPECT_TRUE(same_bytes(factor.solve(Eigen::MatrixXd::Ones(lower.rows(), 1), {}), before));
    }
    EXPECT_GE(changed, 4);
    EXPECT_GE(changed_twice, 2);
  }
}

TEST(MultifrontalFactor, OfAChangedMatrixOutlivesTheFirst) {
  const NormalMatrix lower = lattice_matrix(24, 24);
  const ChangedMatrix once(lower, {50}, {51});
  std::optional<MultifrontalFactor> changed;
  {
    MultifrontalFactor factor(symbolic_factorisation(lower, dissections_of(lower).back(), {}));
    factor.factorise(factor.permuted(lower, {}), {});
    changed = factor.changed(once.change, {});
    factor.factorise(factor.permuted(2.0 * lower, {}), {});
  }
  ASSERT_TRUE(changed);
  EXPECT_LT(inversion_error(once.lower, *changed), 1e-12);
}

TEST(MultifrontalFactor, OfAChangedMatrixIsRefusedIfThatIsIndefinite) {
  const NormalMatrix lower = lattice_matrix(24, 24);
  MultifrontalFactor factor(symbolic_factorisation(lower, dissections_of(lower).back(), {}));
  factor.factorise(factor.permuted(lower, {}), {});
  ChangedMatrix bad(lower, {}, {50});
  bad.change.difference *= -3.0;
  EXPECT_THROW(factor.changed(bad.change, {}), Error);
  EXPECT_LT(inversion_error(lower, factor), 1e-12);
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
