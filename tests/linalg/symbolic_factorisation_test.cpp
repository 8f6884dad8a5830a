#include "linalg/direct/symbolic_factorisation.h"

#include <algorithm>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include "linalg/direct/multifrontal.h"
#include "matrix_families.h"

namespace meshgraft {
namespace {

using Flags = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// Flags the entries of the Cholesky factor for this order, by elimination of a dense matrix of flags.
Flags symbolic_factor(const NormalMatrix& lower, const std::vector<int>& order) {
  const auto count = static_cast<Eigen::Index>(order.size());
  std::vector<Eigen::Index> inverse_permutation(order.size());
  for (Eigen::Index p = 0; p < count; ++p) inverse_permutation[order[p]] = p;
  Flags factor = Flags::Constant(count, count, false);
  for (Eigen::Index column = 0; column < lower.cols(); ++column)
    for (NormalMatrix::InnerIterator it(lower, column); it; ++it) {
      const auto [low, high] = std::minmax(inverse_permutation[it.row()], inverse_permutation[column]);
      factor(high, low) = true;
    }
  for (Eigen::Index p = 0; p < count; ++p)
    for (Eigen::Index column = p + 1; column < count; ++column)
      if (factor(column, p))
        for (Eigen::Index row = column; row < count; ++row)
          if (factor(row, p)) factor(row, column) = true;
  return factor;
}

Eigen::Index entries_of(const Flags& factor) { return factor.cast<Eigen::Index>().sum(); }

Flags stored_entries(const SupernodalPattern& pattern) {
  const auto count = static_cast<Eigen::Index>(pattern.order.size());
  Flags stored = Flags::Constant(count, count, false);
  for (int node = 0; node < pattern.supernodes(); ++node)
    for (int column = pattern.first_position[node]; column < pattern.first_position[node + 1]; ++column)
      for (std::int64_t r = pattern.rows_begin[node]; r < pattern.rows_begin[node + 1]; ++r)
        if (pattern.rows[r] >= column) stored(pattern.rows[r], column) = true;
  return stored;
}

std::vector<std::vector<int>> orders_of(Eigen::Index unknowns) {
  std::vector<int> natural(static_cast<std::size_t>(unknowns));
  std::iota(natural.begin(), natural.end(), 0);
  std::vector<int> backwards(natural.rbegin(), natural.rend()), random = natural;
  std::shuffle(random.begin(), random.end(), std::minstd_rand(2));
  return {natural, backwards, random};
}

/// Returns the patterns of a matrix by minimum degree and for several given orders.
std::vector<SupernodalPattern> patterns_of(const NormalMatrix& lower) {
  std::vector<SupernodalPattern> patterns{symbolic_factorisation(lower, one_leaf(lower.rows()), {})};
  for (const std::vector<int>& order : orders_of(lower.rows()))
    patterns.push_back(symbolic_factorisation(lower, order, {}));
  return patterns;
}

TEST(Supernodes, HaveEveryUnknownOnceAndTheirRowsAscending) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      std::vector<int> unknowns = pattern.order;
      std::sort(unknowns.begin(), unknowns.end());
      EXPECT_EQ(unknowns, orders_of(family.lower.rows()).front()) << family.name;
      ASSERT_EQ(pattern.first_position.front(), 0) << family.name;
      ASSERT_EQ(pattern.first_position.back(), family.lower.rows()) << family.name;
      ASSERT_EQ(pattern.rows_begin.back(), static_cast<std::int64_t>(pattern.rows.size())) << family.name;
      for (int node = 0; node < pattern.supernodes(); ++node) {
        const int first = pattern.first_position[node], columns = pattern.first_position[node + 1] - first;
        const auto begin = pattern.rows.begin() + pattern.rows_begin[node],
                   end = pattern.rows.begin() + pattern.rows_begin[node + 1];
        ASSERT_GT(columns, 0) << family.name;
        ASSERT_GE(end - begin, columns) << family.name;
        for (int c = 0; c < columns; ++c) EXPECT_EQ(begin[c], first + c) << family.name;
        EXPECT_TRUE(std::adjacent_find(begin, end, std::greater_equal<>()) == end) << family.name;
      }
    }
}

TEST(Supernodes, HaveAllEntriesOfTheFactor) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      const Flags factor = symbolic_factor(family.lower, pattern.order), stored = stored_entries(pattern);
      EXPECT_TRUE((factor.array() <= stored.array()).all()) << family.name;
      EXPECT_EQ(pattern.factor_nonzeros(), static_cast<double>(entries_of(stored))) << family.name;
      const Eigen::MatrixXd by_columns = stored.cast<double>().colwise().sum();
      EXPECT_NEAR(pattern.flops(), by_columns.squaredNorm(), 1e-9 * (1 + pattern.flops())) << family.name;
    }
}

// The parent's front must have all rows of the update that a supernode passes on to it.
TEST(Supernodes, HaveRowsBelowThatTheirParentsHave) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      const Flags stored = stored_entries(pattern);
      for (int node = 0; node < pattern.supernodes(); ++node) {
        const std::int64_t below =
            pattern.rows_begin[node] + pattern.first_position[node + 1] - pattern.first_position[node];
        for (std::int64_t r = below; r < pattern.rows_begin[node + 1]; ++r)
          EXPECT_TRUE(stored(pattern.rows[r], pattern.rows[below])) << family.name;
      }
    }
}

TEST(Supernodes, OfAGivenOrderAreOfOneThatFillsTheSame) {
  for (const NamedMatrix& family : matrix_families())
    for (const std::vector<int>& order : orders_of(family.lower.rows())) {
      const SupernodalPattern pattern = symbolic_factorisation(family.lower, order, {});
      EXPECT_EQ(entries_of(symbolic_factor(family.lower, pattern.order)),
                entries_of(symbolic_factor(family.lower, order)))
          << family.name;
    }
}

TEST(Supernodes, StoreNoZerosWhereNothingIsGainedByIt) {
  for (const NamedMatrix& family : matrix_families()) {
    if (family.name != "dense" && family.name != "diagonal" && family.name != "nothing") continue;
    for (const SupernodalPattern& pattern : patterns_of(family.lower))
      EXPECT_EQ(pattern.factor_nonzeros(),
                static_cast<double>(entries_of(symbolic_factor(family.lower, pattern.order))))
          << family.name;
  }
  const SupernodalPattern dense = symbolic_factorisation(lattice_matrix(5, 5, 8), one_leaf(25), {});
  EXPECT_EQ(dense.supernodes(), 1);
}

TEST(Supernodes, StoreFewZerosInLargeOnes) {
  const NormalMatrix lower = lattice_matrix(30, 30, 2);
  for (const SupernodalPattern& pattern : patterns_of(lower)) {
    const auto exact = static_cast<double>(entries_of(symbolic_factor(lower, pattern.order)));
    EXPECT_LT(pattern.factor_nonzeros(), 1.5 * exact);
    EXPECT_LT(pattern.supernodes(), 900 / 3) << "columns are eliminated together";
  }
}

TEST(Supernodes, DoNotDependOnTheNumberOfThreads) {
  const NormalMatrix lower = lattice_matrix(40, 40, 2);
  const auto context = [](int threads) {
    return Context{.threads = threads, .progress = {}, .stop_token = {}};
  };
  for (const std::vector<int>& order : orders_of(lower.rows())) {
    const SupernodalPattern one = symbolic_factorisation(lower, order, context(1)),
                            two = symbolic_factorisation(lower, order, context(2));
    EXPECT_EQ(one.order, two.order);
    EXPECT_EQ(one.rows, two.rows);
  }
}

TEST(MultifrontalFactor, InvertsTheMatrixInWhateverOrder) {
  for (const NamedMatrix& family : matrix_families())
    for (const SupernodalPattern& pattern : patterns_of(family.lower)) {
      MultifrontalFactor factor(pattern);
      factor.factorise(family.lower, {});
      const Eigen::Index n = family.lower.rows();
      const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n), inverse = factor.solve(identity, {});
      EXPECT_LT((family.lower.selfadjointView<Eigen::Lower>() * inverse - identity).norm(), 1e-9)
          << family.name;
    }
}

}  // namespace
}  // namespace meshgraft
