#include "linalg/matrix_change.h"

#include <algorithm>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "linalg/sparse.h"
#include "linalg/sparse_products.h"
#include "matrix_families.h"
#include "random_sparse.h"

namespace meshgraft {
namespace {

/// The rows of a least-squares problem.
struct Rows {
  SparseRows A, G;

  Eigen::MatrixXd normal(const SparseRows& K) const {
    return full_matrix(
        normal_equations({.A = A, .A_transposed = transpose(A), .G = G, .G_transposed = transpose(G), .K = K}));
  }
};

SparseRows banded(int rows, int columns, std::minstd_rand& generator) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < rows; ++row)
    for (int k = -2; k <= 2; ++k)
      if (const int column = row * columns / rows + k; column >= 0 && column < columns)
        entries.emplace_back(row, column, static_cast<double>(generator() % 2001) / 1000.0 - 1.0);
  SparseRows matrix(rows, columns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

/// Returns consecutive numbers for the unknowns that are not removed.
std::vector<int> numbers_without(int unknowns, const std::vector<int>& removed) {
  std::vector<int> number(unknowns);
  int next = 0;
  for (int c = 0; c < unknowns; ++c)
    number[c] = std::find(removed.begin(), removed.end(), c) != removed.end() ? -1 : next++;
  return number;
}

/// Returns the columns that stay, without the rows `dropped`.
SparseRows reduced(const SparseRows& matrix, const std::vector<int>& number, const std::vector<int>& dropped) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int row = 0; row < matrix.rows(); ++row)
    for (SparseRows::InnerIterator it(matrix, row); it; ++it)
      if (number[it.col()] >= 0 && std::find(dropped.begin(), dropped.end(), row) == dropped.end())
        entries.emplace_back(row, number[it.col()], it.value());
  SparseRows result(matrix.rows(), *std::max_element(number.begin(), number.end()) + 1);
  result.setFromTriplets(entries.begin(), entries.end());
  return result;
}

TEST(MatrixChange, IsTheDifferenceOfTheNormalEquations) {
  std::minstd_rand generator(5);
  for (const int unknowns : {90, 150})
    for (const std::vector<int>& removed : {std::vector<int>{}, {0}, {unknowns - 1}, {7, 8, 9}, {3, 30}})
      for (const std::vector<int>& dropped : {std::vector<int>{}, {10}, {20, 21, 22}}) {
        const Rows before{banded(2 * unknowns, unknowns, generator), banded(3 * unknowns, unknowns, generator)};
        const SparseRows P = banded(4 * unknowns, 3 * unknowns, generator), K = transpose(P) * P;
        const std::vector<int> number = numbers_without(unknowns, removed);
        const Rows after{reduced(before.A, number, dropped), reduced(before.G, number, dropped)};
        const auto change =
            change_of_normal({before.A, before.G}, {after.A, after.G}, [&] { return K; }, number, {});
        ASSERT_TRUE(change);
        EXPECT_EQ(change->number, number);
        const Eigen::MatrixXd N = before.normal(K), wanted = after.normal(K),
                              changed = N + full_matrix(change->difference);
        for (int a = 0; a < unknowns; ++a)
          for (int b = 0; b < unknowns; ++b) {
            const bool stay = number[a] >= 0 && number[b] >= 0;
            const double entry = stay ? wanted(number[a], number[b]) : a == b ? N(a, b) : 0.0;
            EXPECT_NEAR(changed(a, b), entry, 1e-12 * N.norm()) << a << ", " << b;
            EXPECT_TRUE(N(a, b) != 0 || changed(a, b) == 0);
          }
      }
}

TEST(MatrixChange, IsRefusedWhereItWouldAddEntriesOrChangeMost) {
  std::minstd_rand generator(6);
  const Rows rows{banded(80, 40, generator), banded(120, 40, generator)};
  const SparseRows P = banded(160, 120, generator), K = transpose(P) * P;
  const std::vector<int> all = numbers_without(40, {}), fewer = numbers_without(40, {4});
  const auto change = [&](const Rows& before, const Rows& after, const std::vector<int>& number) {
    return change_of_normal({before.A, before.G}, {after.A, after.G}, [&] { return K; }, number, {})
        .has_value();
  };
  const Rows without_row{reduced(rows.A, all, {}), reduced(rows.G, all, {5})},
      without_unknown{reduced(rows.A, fewer, {}), reduced(rows.G, fewer, {})};
  EXPECT_TRUE(change(rows, without_row, all));
  EXPECT_FALSE(change(without_row, rows, all));                          // entries that were not there
  EXPECT_FALSE(change(without_unknown, rows, numbers_without(39, {})));  // an unknown that was not there
  EXPECT_FALSE(change(rows, {SparseRows(2.0 * rows.A), rows.G}, all));   // all rows
}

}  // namespace
}  // namespace meshgraft
