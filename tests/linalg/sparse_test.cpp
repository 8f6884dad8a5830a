#include <meshgraft/linalg/linear_solver.h>

#include <algorithm>
#include <array>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "linalg/sparse.h"
#include "matrix_families.h"
#include "random_sparse.h"

namespace meshgraft {
namespace {

TEST(Sparse, TransposesAsEigenDoes) {
  for (const SparsePair& family : sparse_families()) {
    SparseRows expected = family.a.transpose();
    expected.makeCompressed();
    EXPECT_TRUE(same_bytes(transpose(family.a), expected)) << family.name;
  }
}

TEST(Sparse, IsTheTransposeOfItsTranspose) {
  for (const SparsePair& family : sparse_families())
    EXPECT_TRUE(same_bytes(transpose(transpose(family.a)), family.a)) << family.name;
}

TEST(Sparse, TransposesToTheSameBytesForAnyNumberOfThreads) {
  for (const SparsePair& family : sparse_families())
    for (const int threads : {2, 3})
      EXPECT_TRUE(same_bytes(transpose(family.a, with_threads(threads)), transpose(family.a, with_threads(1))))
          << family.name;
}

TEST(Sparse, TimesColumnsIsEigensProduct) {
  for (const SparsePair& family : sparse_families())
    for (int columns = 0; columns <= 20; ++columns) {
      const Columns x = Columns::Random(family.a.cols(), columns), expected = family.a * x;
      EXPECT_LE((multiply(family.a, x) - expected).norm(), 1e-12 * expected.norm()) << family.name << columns;
      const Columns before = Columns::Random(family.a.rows(), columns);
      Columns sum = before;
      add_product(family.a, x, sum, {});
      EXPECT_LE((sum - before - expected).norm(), 1e-12 * (before.norm() + expected.norm()))
          << family.name << columns;
    }
}

TEST(Sparse, TimesColumnsWithEachOfTheProcessorsInstructions) {
  using platform::VectorInstructions;
  for (const auto instructions :
       {VectorInstructions::baseline, VectorInstructions::avx2, VectorInstructions::avx512}) {
    if (instructions > platform::vector_instructions()) continue;
    SCOPED_TRACE(static_cast<int>(instructions));
    for (const SparsePair& family : sparse_families())
      for (const int columns : {0, 1, 2, 3, 4, 5, 7, 8, 11, 16, 19, 31, 32, 35, 67}) {
        const Columns x = Columns::Random(family.a.cols(), columns + 2), all = family.a * x;
        Columns expected(all.rows(), columns);
        if (all.rows() > 0)
          expected = all.middleCols(1, columns);  // Eigen's blocks of null pointers are undefined
        Columns product(all.rows(), columns);
        multiply_columns(family.a, x, 1, columns, product, 0, {}, instructions);
        EXPECT_LE((product - expected).norm(), 1e-12 * expected.norm()) << family.name << columns;
        const Columns before = Columns::Random(family.a.rows(), columns + 2);
        Columns sum = before;
        add_product(family.a, x, sum, {}, instructions);
        EXPECT_LE((sum - before - all).norm(), 1e-12 * (before.norm() + all.norm())) << family.name << columns;
      }
  }
}

TEST(Sparse, TimesSomeColumnsSetsThatPartOfTheProduct) {
  for (const SparsePair& family : sparse_families()) {
    const Columns x = Columns::Random(family.a.cols(), 23), all = multiply(family.a, x);
    if (all.rows() == 0) continue;  // Eigen's blocks of null pointers are undefined
    for (const auto& [first, count] : {std::pair{0, 23}, {3, 16}, {22, 1}, {5, 0}})
      for (const Eigen::Index at : {0, 2, 9}) {
        const Columns before = Columns::Random(all.rows(), 32);
        Columns expected = before, product = before;
        expected.middleCols(at, count) = all.middleCols(first, count);
        multiply_columns(family.a, x, first, count, product, at, {});
        EXPECT_TRUE(same_bytes(product, expected)) << family.name << first << at;
      }
  }
}

TEST(Sparse, TimesColumnsHasTheSameBytesForAnyNumberOfThreads) {
  for (const SparsePair& family : sparse_families()) {
    const Columns x = Columns::Random(family.a.cols(), 13), one = multiply(family.a, x, with_threads(1));
    for (const int threads : {2, 3})
      EXPECT_TRUE(same_bytes(multiply(family.a, x, with_threads(threads)), one)) << family.name;
  }
}

TEST(Sparse, TransposedMovesToTheOtherSideOfAnInnerProduct) {
  for (const SparsePair& family : sparse_families()) {
    const Columns x = Columns::Random(family.a.cols(), 3), y = Columns::Random(family.a.rows(), 3);
    const Columns along = multiply(family.a, x), back = multiply(transpose(family.a), y);
    EXPECT_NEAR(y.cwiseProduct(along).sum(), back.cwiseProduct(x).sum(),
                1e-12 * (1 + along.norm()) * (1 + y.norm()))
        << family.name;
  }
}

TEST(Sparse, StacksTheRowsOfBoth) {
  std::minstd_rand generator(3);
  for (const SparsePair& family : sparse_families()) {
    const SparseRows& top = family.a;
    const SparseRows bottom = random_runs(17, static_cast<int>(top.cols()), 2, generator),
                     both = stack(top, bottom);
    EXPECT_TRUE(same_bytes(SparseRows(both.topRows(top.rows())), top)) << family.name;
    EXPECT_TRUE(same_bytes(SparseRows(both.bottomRows(17)), bottom)) << family.name;
    const Columns x = Columns::Random(top.cols(), 3), y = multiply(both, x);
    EXPECT_TRUE(same_bytes(Columns(y.topRows(top.rows())), multiply(top, x))) << family.name;
    EXPECT_TRUE(same_bytes(Columns(y.bottomRows(17)), multiply(bottom, x))) << family.name;
  }
}

TEST(Sparse, HasRoomForRowsOfGivenLengths) {
  for (const SparsePair& family : sparse_families()) {
    std::vector<int> lengths;
    for (Eigen::Index row = 0; row < family.a.rows(); ++row)
      lengths.push_back(static_cast<int>(family.a.row(row).nonZeros()));
    SparseRows copy = rows_of_lengths(lengths, family.a.cols());
    ASSERT_EQ(copy.nonZeros(), family.a.nonZeros()) << family.name;
    std::copy_n(family.a.innerIndexPtr(), copy.nonZeros(), copy.innerIndexPtr());
    std::copy_n(family.a.valuePtr(), copy.nonZeros(), copy.valuePtr());
    EXPECT_TRUE(same_bytes(copy, family.a)) << family.name;
  }
}

TEST(Sparse, RefusesMoreEntriesThanItsIndicesCount) {
  const std::array<int, 3> lengths{1 << 30, 1 << 30, 1};
  try {
    rows_of_lengths(lengths, 1 << 30);
    FAIL() << "made a matrix with 2^31 + 1 entries";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::input);
    EXPECT_EQ(error.id(), "linalg.operator_too_large");
  }
}

}  // namespace
}  // namespace meshgraft
