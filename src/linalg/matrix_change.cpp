#include "matrix_change.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/parallel.h"
#include "sparse.h"
#include "sparse_products.h"

namespace meshgraft {

namespace {

enum class RowChange : std::uint8_t { none, some, new_entries };

/// Compares two rows, where column c of `before` is column `number[c]` of `after`.
RowChange compare(SparseRows::InnerIterator before, SparseRows::InnerIterator after,
                  const std::vector<int>& number) {
  RowChange change = RowChange::none;
  for (; after; ++before, ++after) {
    for (; before && number[before.col()] != after.col(); ++before) change = RowChange::some;
    if (!before) return RowChange::new_entries;
    if (before.value() != after.value()) change = RowChange::some;
  }
  return before ? RowChange::some : change;
}

/// Returns the rows that differ, or nullopt if many do or one has new entries.
std::optional<std::vector<int>> differing_rows(const SparseRows& before, const SparseRows& after,
                                               const std::vector<int>& number, const Context& context) {
  constexpr double largest_share = 0.25;
  std::vector<RowChange> changes(before.rows());
  parallel_blocks(
      changes.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const auto row = static_cast<Eigen::Index>(k);
          changes[k] = compare({before, row}, {after, row}, number);
        }
      },
      context);
  std::vector<int> rows;
  for (std::size_t row = 0; row < changes.size(); ++row) {
    if (changes[row] == RowChange::new_entries) return std::nullopt;
    if (changes[row] == RowChange::some) rows.push_back(static_cast<int>(row));
  }
  if (static_cast<double>(rows.size()) > largest_share * static_cast<double>(changes.size()))
    return std::nullopt;
  return rows;
}

/// Returns the given rows of a matrix with `columns` columns. Column c becomes column `column_of[c]`.
SparseRows rows_at(const SparseRows& matrix, const std::vector<int>& rows, const std::vector<int>& column_of,
                   Eigen::Index columns) {
  std::vector<int> lengths;
  for (const int row : rows) lengths.push_back(matrix.outerIndexPtr()[row + 1] - matrix.outerIndexPtr()[row]);
  SparseRows chosen = rows_of_lengths(lengths, columns);
  for (std::size_t k = 0; k < rows.size(); ++k) {
    int entry = chosen.outerIndexPtr()[k];
    for (SparseRows::InnerIterator it(matrix, rows[k]); it; ++it, ++entry) {
      chosen.innerIndexPtr()[entry] = column_of.empty() ? static_cast<int>(it.col()) : column_of[it.col()];
      chosen.valuePtr()[entry] = it.value();
    }
  }
  return chosen;
}

/// Returns `rows` as the given rows of a matrix with `count` rows.
SparseRows spread_rows(const SparseRows& chosen, const std::vector<int>& rows, Eigen::Index count) {
  std::vector<int> lengths(count, 0);
  for (std::size_t k = 0; k < rows.size(); ++k)
    lengths[rows[k]] = chosen.outerIndexPtr()[k + 1] - chosen.outerIndexPtr()[k];
  SparseRows all = rows_of_lengths(lengths, chosen.cols());
  std::copy_n(chosen.innerIndexPtr(), chosen.nonZeros(), all.innerIndexPtr());
  std::copy_n(chosen.valuePtr(), chosen.nonZeros(), all.valuePtr());
  return all;
}

/// Returns the lower triangle of a symmetric matrix, with zeros on the diagonals of removed unknowns.
NormalMatrix lower_triangle(const SparseRows& matrix, const std::vector<int>& number) {
  NormalMatrix lower(matrix.rows(), matrix.rows());
  for (Eigen::Index k = 0; k < matrix.rows(); ++k) {
    lower.startVec(k);
    for (SparseRows::InnerIterator it(matrix, k); it; ++it)
      if (it.col() >= k) lower.insertBack(it.col(), k) = it.col() == k && number[k] < 0 ? 0.0 : it.value();
  }
  lower.finalize();
  return lower;
}

}  // namespace

std::optional<MatrixChange> change_of_normal(const RowsOfNormal& before, const RowsOfNormal& after,
                                             const std::function<SparseRows()>& K, std::vector<int> number,
                                             const Context& context) {
  std::vector<int> former(after.A.cols(), -1);
  for (std::size_t c = 0; c < number.size(); ++c)
    if (number[c] >= 0) former[number[c]] = static_cast<int>(c);
  if (std::count(former.begin(), former.end(), -1) > 0) return std::nullopt;
  const auto in_A = differing_rows(before.A, after.A, number, context),
             in_G = in_A ? differing_rows(before.G, after.G, number, context) : std::nullopt;
  if (!in_G) return std::nullopt;

  const Eigen::Index unknowns = before.A.cols();
  const SparseRows A_before = rows_at(before.A, *in_A, {}, unknowns),
                   A_after = rows_at(after.A, *in_A, former, unknowns);
  SparseRows difference = difference_of_products({transpose(A_after, context), A_after},
                                                 {transpose(A_before, context), A_before}, context);
  // With D = G_before − G_after, GᵀKG changes by −(S + Sᵀ), where S = Dᵀ K (G_before − D / 2).
  const SparseRows D = rows_at(before.G, *in_G, {}, unknowns) - rows_at(after.G, *in_G, former, unknowns);
  const SparseRows K_rows = rows_at(K(), *in_G, {}, before.G.rows());
  const SparseRows half = spread_rows(0.5 * D, *in_G, before.G.rows());
  const SparseRows S = multiply(transpose(D, context),
                                difference_of_products({K_rows, before.G}, {K_rows, half}, context), context);
  take_over(difference, SparseRows(difference - S));
  take_over(difference, SparseRows(difference - transpose(S, context)));
  return MatrixChange{lower_triangle(difference, number), std::move(number)};
}

}  // namespace meshgraft
