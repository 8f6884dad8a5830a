#include "linalg/sparse_products.h"

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Eigenvalues>

#include <meshgraft/core/error.h>

#include "linalg/sparse.h"
#include "matrix_families.h"
#include "random_sparse.h"

namespace meshgraft {
namespace {

TEST(SparseProducts, AreEigensWithSortedColumns) {
  for (const SparsePair& family : sparse_families()) {
    const SparseRows product = multiply(family.a, family.b);
    const Eigen::MatrixXd expected = Eigen::MatrixXd(family.a) * Eigen::MatrixXd(family.b);
    EXPECT_LE((Eigen::MatrixXd(product) - expected).norm(), 1e-12 * expected.norm()) << family.name;
    for (Eigen::Index row = 0; row < product.rows(); ++row)
      EXPECT_TRUE(std::adjacent_find(product.innerIndexPtr() + product.outerIndexPtr()[row],
                                     product.innerIndexPtr() + product.outerIndexPtr()[row + 1],
                                     std::greater_equal<>()) ==
                  product.innerIndexPtr() + product.outerIndexPtr()[row + 1])
          << family.name;
  }
}

TEST(SparseProducts, HaveTheSameBytesForAnyNumberOfThreads) {
  for (const SparsePair& family : sparse_families()) {
    const SparseRows K = multiply(family.a, transpose(family.a));
    const SparseRows a_transposed = transpose(family.a), b_transposed = transpose(family.b);
    const NormalTerms terms{
        .A = family.a, .A_transposed = a_transposed, .G = family.a, .G_transposed = a_transposed, .K = K};
    const SparseProduct product{family.a, family.b}, other{K, multiply(family.a, family.b)};
    for (const int threads : {2, 3}) {
      const Context one = with_threads(1), several = with_threads(threads);
      EXPECT_TRUE(same_bytes(multiply(family.a, family.b, several), multiply(family.a, family.b, one)))
          << family.name;
      EXPECT_TRUE(same_bytes(difference_of_products(product, other, several),
                             difference_of_products(product, other, one)))
          << family.name;
      EXPECT_TRUE(same_bytes(normal_equations(terms, several), normal_equations(terms, one))) << family.name;
    }
  }
}

/// Returns the Frobenius norm; Eigen's refuses matrices without rows or columns.
double frobenius_norm(const SparseRows& matrix) { return matrix.size() == 0 ? 0.0 : matrix.norm(); }

TEST(SparseProducts, TransposeToTheProductOfTheTransposesInReverse) {
  for (const SparsePair& family : sparse_families()) {
    const SparseRows transposed = transpose(multiply(family.a, family.b)),
                     reverse = multiply(transpose(family.b), transpose(family.a));
    EXPECT_EQ(transposed.nonZeros(), reverse.nonZeros()) << family.name;
    EXPECT_LE(frobenius_norm(transposed - reverse), 1e-12 * frobenius_norm(transposed)) << family.name;
  }
}

TEST(SparseProducts, DifferAsTheirDifferenceDoes) {
  for (const SparsePair& family : sparse_families()) {
    const SparseRows c = multiply(family.a, family.b), d = 2.0 * family.b;
    const SparseRows difference = difference_of_products({family.a, d}, {family.a, family.b});
    EXPECT_LE(frobenius_norm(difference - c), 1e-12 * frobenius_norm(c)) << family.name;
    EXPECT_LE(frobenius_norm(difference_of_products({family.a, family.b}, {family.a, family.b})),
              1e-12 * frobenius_norm(c))
        << family.name;
  }
}

/// Returns three multiples of a matrix, of which the last is zero with the same entries.
AlikeRows multiples(const SparseRows& matrix) { return {matrix, -3 * matrix, 0 * matrix}; }

TEST(SparseProducts, OfThreeMatricesAlikeAreThoseOfEach) {
  for (const SparsePair& family : sparse_families()) {
    const SparseRows a = transpose(family.b), b = transpose(family.a), d = 2.0 * transpose(family.b);
    const AlikeRows c = multiples(family.a), e = multiples(multiply(b, family.a));
    const AlikeTerms terms{.a = a, .b = b, .c = c, .d = d, .e = e};
    const AlikeRows products = alike_products(terms, with_threads(1)),
                    other = alike_products(terms, with_threads(3));
    for (std::size_t k = 0; k < 3; ++k) {
      const SparseRows expected = multiply(multiply(a, b), c[k]) - multiply(d, e[k]);
      EXPECT_LE(frobenius_norm(products[k] - expected), 1e-12 * frobenius_norm(multiply(d, e[0])))
          << family.name;
      EXPECT_EQ(products[k].nonZeros(), products[0].nonZeros()) << family.name;
      EXPECT_TRUE(same_bytes(products[k], other[k])) << family.name;
    }
  }
}

TEST(NormalEquations, AreTheLowerTriangleOfASymmetricMatrix) {
  for (const SparsePair& family : sparse_families()) {
    // A and G are both of the pair: G has as many columns as A, K has as many rows as G.
    const SparseRows A = multiply(family.a, family.b), A_transposed = transpose(A);
    const SparseRows& G = family.b;
    const SparseRows G_transposed = transpose(G), half = multiply(transpose(family.a), family.a);
    const NormalMatrix lower = normal_equations(
        {.A = A, .A_transposed = A_transposed, .G = G, .G_transposed = G_transposed, .K = half});
    for (Eigen::Index column = 0; column < lower.cols(); ++column)
      for (NormalMatrix::InnerIterator it(lower, column); it; ++it) EXPECT_GE(it.row(), column) << family.name;
    // With K = aᵀa the sum is 2 (a b)ᵀ (a b), which a vector sees as 2 |a b x|².
    const Columns x = Columns::Random(lower.cols(), 1), ax = multiply(A, x);
    const double energy = x.col(0).dot(lower.selfadjointView<Eigen::Lower>() * x.col(0));
    EXPECT_NEAR(energy, 2 * ax.squaredNorm(), 1e-11 * (1 + ax.squaredNorm())) << family.name;
  }
}

TEST(SparseProducts, HaveNoMoreEntriesThanTheirIndicesCount) {
  constexpr std::int64_t most = std::numeric_limits<int>::max();
  EXPECT_NO_THROW(require_countable(0));
  EXPECT_NO_THROW(require_countable(most));
  EXPECT_THROW(require_countable(most + 1), Error);
}

TEST(SparseProducts, AgreeWithEigenAndDoNotDependOnThreads) {
  std::srand(7);
  std::vector<Eigen::Triplet<double>> a_entries, b_entries;
  for (int k = 0; k < 20000; ++k) {
    a_entries.emplace_back(std::rand() % 1500, std::rand() % 900, std::rand() / double(RAND_MAX) - 0.5);
    b_entries.emplace_back(std::rand() % 900, std::rand() % 1100, std::rand() / double(RAND_MAX) - 0.5);
  }
  SparseRows a(1500, 900), b(900, 1100);
  a.setFromTriplets(a_entries.begin(), a_entries.end());
  b.setFromTriplets(b_entries.begin(), b_entries.end());
  const SparseRows one = multiply(a, b, with_threads(1));
  const SparseRows two = multiply(a, b, with_threads(2));
  const SparseRows eigen = a * b;
  EXPECT_LT((one - eigen).norm(), 1e-12 * eigen.norm());
  ASSERT_EQ(one.nonZeros(), two.nonZeros());
  EXPECT_TRUE(same_bytes(one, two));

  const SparseRows back = transpose(a, with_threads(2)), eigens = a.transpose();
  EXPECT_EQ((back - eigens).norm(), 0);
  EXPECT_EQ(back.nonZeros(), eigens.nonZeros());
  EXPECT_EQ((stack(a, a).bottomRows(1500) - a).norm(), 0);
  EXPECT_LT((difference_of_products({a, b}, {a, b})).norm(), 1e-12 * eigen.norm());

  for (int columns : {1, 3, 8}) {
    const Columns x = Columns::Random(900, columns);
    EXPECT_LT((multiply(a, x) - a * x).norm(), 1e-12 * x.norm());
  }
}

TEST(SparseProducts, TakeRowsWithTheSameColumnsTogether) {
  std::minstd_rand generator(11);
  for (const int together : {1, 2, 3, 4, 5}) {
    const SparseRows a = random_runs(200, 300, together, generator),
                     b = random_runs(300, 150, together, generator);
    EXPECT_LT((multiply(a, b) - SparseRows(a * b)).norm(), 1e-12) << together;
    const SparseRows columnwise = transpose(a);  // has runs of columns
    EXPECT_LT((multiply(columnwise, a) - SparseRows(columnwise * a)).norm(), 1e-12) << together;

    const SparseRows K = multiply(transpose(random_runs(50, 300, together, generator)),
                                  random_runs(50, 300, together, generator));
    const SparseRows symmetric = K + transpose(K), A = random_runs(80, 150, together, generator);
    const Eigen::MatrixXd expected = Eigen::MatrixXd(SparseRows(transpose(A) * A)) +
                                     Eigen::MatrixXd(SparseRows(transpose(b) * symmetric * b));
    const NormalMatrix lower = normal_equations(
        {.A = A, .A_transposed = transpose(A), .G = b, .G_transposed = transpose(b), .K = symmetric});
    EXPECT_LT((Eigen::MatrixXd(lower) - Eigen::MatrixXd(expected.triangularView<Eigen::Lower>())).norm(),
              1e-10);
  }
}

TEST(SparseProducts, LowerTriangleIsThatOfTheFullSum) {
  const NormalMatrix lower = grid_matrix(8);
  const Eigen::MatrixXd half = Eigen::MatrixXd(lower);
  EXPECT_EQ(half.triangularView<Eigen::StrictlyUpper>().toDenseMatrix().norm(), 0);
  EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(full_matrix(lower)).eigenvalues()[0], 0);
}

}  // namespace
}  // namespace meshgraft
