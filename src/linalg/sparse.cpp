#include "sparse.h"

#include <algorithm>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "core/sparse_checks.h"
#include "sparse_products.h"

namespace meshgraft {

namespace {

enum class Result { set, add };

/// Computes columns [first, first + width) of y = a·x or y ← y + a·x, from those `skipped` further on in x.
template <int width, Result result>
void multiply_columns(const SparseRows& a, const Columns& x, Eigen::Index skipped, Eigen::Index first,
                      Columns& y, const Context& context) {
  using Row = Eigen::Matrix<double, 1, width>;
  constexpr Eigen::Index entries_at_once = 32'768;
  const std::size_t rows_at_once =
      std::clamp<Eigen::Index>(entries_at_once * a.rows() / std::max<Eigen::Index>(a.nonZeros(), 1), 16, 4096);
  parallel_blocks(
      a.rows(),
      [&](std::size_t begin, std::size_t end) {
        for (auto row = static_cast<Eigen::Index>(begin); row < static_cast<Eigen::Index>(end); ++row) {
          auto out = y.row(row).template segment<width>(first);
          Row sum = Row::Zero();
          for (SparseRows::InnerIterator it(a, row); it; ++it)
            sum += it.value() * x.row(it.col()).template segment<width>(skipped + first);
          if constexpr (result == Result::add) sum += out;
          out = sum;
        }
      },
      context, rows_at_once);
}

/// Does the same for all columns. Widths are compile-time constants, so that sums stay in registers and no row
/// allocates memory.
template <Result result>
void multiply_all_columns(const SparseRows& a, const Columns& x, Eigen::Index skipped, Columns& y,
                          const Context& context) {
  Eigen::Index first = 0;
  while (const Eigen::Index left = y.cols() - first) {
    if (left == 3) {
      multiply_columns<3, result>(a, x, skipped, first, y, context);
      first += 3;
    } else if (left >= 8) {
      multiply_columns<8, result>(a, x, skipped, first, y, context);
      first += 8;
    } else if (left >= 4) {
      multiply_columns<4, result>(a, x, skipped, first, y, context);
      first += 4;
    } else {
      multiply_columns<1, result>(a, x, skipped, first, y, context);
      first += 1;
    }
  }
}

}  // namespace

Columns multiply(const SparseRows& a, const Columns& x, const Context& context) {
  Columns y;
  multiply(a, x, y, context);
  return y;
}

void multiply(const SparseRows& a, const Columns& x, Columns& y, const Context& context) {
  multiply(a, x, 0, x.cols(), y, context);
}

void multiply(const SparseRows& a, const Columns& x, Eigen::Index first, Eigen::Index count, Columns& y,
              const Context& context) {
  y.resize(a.rows(), count);
  multiply_all_columns<Result::set>(a, x, first, y, context);
}

void add_product(const SparseRows& a, const Columns& x, Columns& y, const Context& context) {
  multiply_all_columns<Result::add>(a, x, 0, y, context);
}

SparseRows stack(const SparseRows& top, const SparseRows& bottom, const Context& context) {
  // Piece by piece: a gigabyte takes a third of a second.
  const auto copy = [&](const auto* from, std::int64_t count, auto* to) {
    constexpr std::int64_t piece = std::int64_t{1} << 22;
    for (std::int64_t done = 0; done < count; done += piece) {
      context.throw_if_stopped();
      std::copy_n(from + done, std::min(piece, count - done), to + done);
    }
    return to + count;
  };
  SparseRows stacked(top.rows() + bottom.rows(), top.cols());
  stacked.resizeNonZeros(top.nonZeros() + bottom.nonZeros());
  int *outer = stacked.outerIndexPtr(), *inner = stacked.innerIndexPtr();
  double* values = stacked.valuePtr();
  int entries = 0;
  for (const SparseRows* part : {&top, &bottom}) {
    outer = std::transform(part->outerIndexPtr(), part->outerIndexPtr() + part->rows() + 1, outer,
                           [&](int offset) { return entries + offset; }) -
            1;
    const auto count = static_cast<int>(part->nonZeros());
    inner = copy(part->innerIndexPtr(), count, inner);
    values = copy(part->valuePtr(), count, values);
    entries += count;
  }
  return stacked;
}

SparseRows rows_of_lengths(std::span<const int> lengths, Eigen::Index columns) {
  SparseRows matrix(static_cast<Eigen::Index>(lengths.size()), columns);
  std::int64_t entries = 0;
  for (std::size_t row = 0; row < lengths.size(); ++row) {
    matrix.outerIndexPtr()[row] = static_cast<int>(entries);
    entries += lengths[row];
  }
  require_countable(entries);
  matrix.outerIndexPtr()[lengths.size()] = static_cast<int>(entries);
  matrix.resizeNonZeros(entries);
  return matrix;
}

SparseRows transpose(const SparseRows& a, const Context& context) {
  SparseRows transposed(a.cols(), a.rows());
  transposed.resizeNonZeros(a.nonZeros());
  int* outer = transposed.outerIndexPtr();
  std::fill_n(outer, a.cols() + 1, 0);
  const auto for_each_entry = [&](const auto& body) {
    share_out(
        static_cast<int>(a.cols()),
        [&](int first, int last) {
          SparseChecks check(context);
          for (Eigen::Index row = 0; row < a.rows(); ++row, check())
            for (SparseRows::InnerIterator it(a, row); it; ++it)
              if (it.col() >= first && it.col() < last) body(static_cast<int>(row), it);
        },
        context);
  };
  for_each_entry([&](int, const SparseRows::InnerIterator& it) { ++outer[it.col() + 1]; });
  std::partial_sum(outer, outer + a.cols() + 1, outer);
  std::vector<int> next(outer, outer + a.cols());
  for_each_entry([&](int row, const SparseRows::InnerIterator& it) {
    const int entry = next[it.col()]++;
    transposed.innerIndexPtr()[entry] = row;
    transposed.valuePtr()[entry] = it.value();
  });
  return transposed;
}

}  // namespace meshgraft
