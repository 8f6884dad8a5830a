#include "linalg/direct/symbolic_factorisation.h"

#include <algorithm>
#include <functional>

#include <gtest/gtest.h>

#include "matrix_families.h"
#include "pattern_families.h"

namespace meshgraft {
namespace {

using EntryFlags = Eigen::Matrix<bool, Eigen::Dynamic, Eigen::Dynamic>;

/// EntryFlags the entries of the Cholesky factor for this order, by elimination of a dense matrix of flags.
EntryFlags symbolic_factor(const NormalMatrix& lower, const std::vector<int>& order) {
  const auto count = static_cast<Eigen::Index>(order.size());
  std::vector<Eigen::Index> inverse_permutation(order.size());
  for (Eigen::Index p = 0; p < count; ++p) inverse_permutation[order[p]] = p;
  EntryFlags factor = EntryFlags::Constant(count, count, false);
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

Eigen::Index entries_of(const EntryFlags& factor) { return factor.cast<Eigen::Index>().sum(); }

EntryFlags stored_entries(const SupernodalPattern& pattern) {
  const auto count = static_cast<Eigen::Index>(pattern.order.size());
  EntryFlags stored = EntryFlags::Constant(count, count, false);
  for (int node = 0; node < pattern.supernodes(); ++node)
    for (int column = pattern.first_position[node]; column < pattern.first_position[node + 1]; ++column)
      for (std::int64_t r = pattern.rows_begin[node]; r < pattern.rows_begin[node + 1]; ++r)
        if (pattern.rows[r] >= column) stored(pattern.rows[r], column) = true;
  return stored;
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
      const EntryFlags factor = symbolic_factor(family.lower, pattern.order), stored = stored_entries(pattern);
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
      const EntryFlags stored = stored_entries(pattern);
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
  const auto expect_same = [&](const auto& how) {
    const SupernodalPattern one = symbolic_factorisation(lower, how, with_threads(1));
    for (const int threads : {2, 3}) {
      const SupernodalPattern several = symbolic_factorisation(lower, how, with_threads(threads));
      EXPECT_EQ(one.order, several.order);
      EXPECT_EQ(one.first_position, several.first_position);
      EXPECT_EQ(one.rows, several.rows);
    }
  };
  for (const std::vector<int>& order : orders_of(lower.rows())) expect_same(order);
  for (const Dissection& dissection : dissections_of(lower)) expect_same(dissection);
}

// A separator is one supernode, whatever its pattern.
TEST(Supernodes, HaveEachSeparatorInOne) {
  for (const NamedMatrix& family : matrix_families())
    for (const Dissection& dissection : dissections_of(family.lower)) {
      const SupernodalPattern pattern = symbolic_factorisation(family.lower, dissection, {});
      std::vector<std::vector<int>> nodes;
      for (int node = 0; node < pattern.supernodes(); ++node) {
        nodes.emplace_back(pattern.order.begin() + pattern.first_position[node],
                           pattern.order.begin() + pattern.first_position[node + 1]);
        std::sort(nodes.back().begin(), nodes.back().end());
      }
      for (int set = 0; set < dissection.sets(); ++set) {
        if (dissection.is_leaf(set) || dissection.unknowns[set].empty()) continue;
        EXPECT_EQ(std::count(nodes.begin(), nodes.end(), dissection.unknowns[set]), 1) << family.name;
      }
    }
}

TEST(LowerEntries, AreTheMatrixInTheGivenOrderForAnyNumberOfThreads) {
  for (const NamedMatrix& family : matrix_families())
    for (const std::vector<int>& inverse_permutation : orders_of(family.lower.rows())) {
      const Eigen::Index n = family.lower.rows();
      const Eigen::MatrixXd full = full_matrix(family.lower);
      for (const int threads : {1, 2, 3}) {
        const LowerEntries entries = permute(family.lower, inverse_permutation, true, with_threads(threads));
        ASSERT_EQ(entries.begin.size(), inverse_permutation.size() + 1) << family.name;
        ASSERT_EQ(entries.begin.back(), family.lower.nonZeros()) << family.name;
        Eigen::MatrixXd permuted = Eigen::MatrixXd::Zero(n, n);
        for (Eigen::Index p = 0; p < n; ++p)
          for (std::int64_t e = entries.begin[p]; e < entries.begin[p + 1]; ++e) {
            EXPECT_GE(entries.row[e], p) << family.name;
            permuted(entries.row[e], p) = permuted(p, entries.row[e]) = entries.value[e];
          }
        EXPECT_EQ(permuted(inverse_permutation, inverse_permutation), full) << family.name;
        const LowerEntries pattern = permute(family.lower, inverse_permutation, false, with_threads(threads));
        EXPECT_EQ(pattern.row, entries.row) << family.name;
        EXPECT_TRUE(pattern.value.empty()) << family.name;
      }
    }
}

}  // namespace
}  // namespace meshgraft
