#include "sparse.h"

#include <algorithm>
#include <cassert>
#include <cstdint>
#include <numeric>
#include <span>
#include <vector>

#include "core/parallel.h"
#include "core/sparse_checks.h"
#include "lanes.h"
#include "sparse_products.h"

namespace meshgraft {

namespace {

using simd::Lanes;
using simd::load;
using simd::store;

enum class Result { set, add };

/// Rows [begin, end) of a sparse matrix and some columns of dense ones, stored row by row.
struct RowProduct {
  Eigen::Index begin, end;
  const int* outer;
  const int* inner;
  const double* values;
  const double* x;
  Eigen::Index x_stride;
  double* y;
  Eigen::Index y_stride;
};

/// Computes y = a·x or y ← y + a·x for lanes·vectors columns.
template <int lanes, int vectors, Result result>
MESHGRAFT_INLINE void multiply_rows(const RowProduct& p) {
  for (Eigen::Index row = p.begin; row < p.end; ++row) {
    Lanes<lanes> sum[vectors] = {};
    for (int e = p.outer[row]; e < p.outer[row + 1]; ++e) {
      const double value = p.values[e];
      const double* from = p.x + p.inner[e] * p.x_stride;
      for (int v = 0; v < vectors; ++v) {
        Lanes<lanes> part;
        load<lanes>(from + v * lanes, part);
        sum[v] += value * part;
      }
    }
    double* to = p.y + row * p.y_stride;
    for (int v = 0; v < vectors; ++v) {
      if constexpr (result == Result::add) {
        Lanes<lanes> before;
        load<lanes>(to + v * lanes, before);
        sum[v] += before;
      }
      store<lanes>(sum[v], to + v * lanes);
    }
  }
}

/// Does the same for three columns, in four lanes. The fourth is the next row's first number, of no use.
template <Result result>
MESHGRAFT_INLINE void multiply_rows_of_three(const RowProduct& p, const double* x_end) {
  for (Eigen::Index row = p.begin; row < p.end; ++row) {
    Lanes<4> sum = {};
    for (int e = p.outer[row]; e < p.outer[row + 1]; ++e) {
      const double* from = p.x + p.inner[e] * p.x_stride;
      Lanes<4> part;
      if (x_end - from >= 4)
        load<4>(from, part);
      else
        part = Lanes<4>{from[0], from[1], from[2], 0};
      sum += p.values[e] * part;
    }
    double* to = p.y + row * p.y_stride;
    for (int c = 0; c < 3; ++c) to[c] = result == Result::add ? to[c] + sum[c] : sum[c];
  }
}

/// Calls the kernel for a number of columns: 32, 16, 8, 4, 3 or 1.
template <int widest, Result result>
MESHGRAFT_INLINE void multiply_rows_of(int width, RowProduct p, const double* x_end) {
  switch (width) {
    case 32:
      if constexpr (widest > 2) return multiply_rows<widest, 32 / widest, result>(p);
      multiply_rows<widest, 16 / widest, result>(p);
      p.x += 16;
      p.y += 16;
      return multiply_rows<widest, 16 / widest, result>(p);
    case 16: return multiply_rows<widest, 16 / widest, result>(p);
    case 8: return multiply_rows<widest, 8 / widest, result>(p);
    case 4: return multiply_rows<std::min(widest, 4), 4 / std::min(widest, 4), result>(p);
    case 3:
      if constexpr (widest > 2) return multiply_rows_of_three<result>(p, x_end);
      return multiply_rows<1, 3, result>(p);
    default: return multiply_rows<1, 1, result>(p);
  }
}

template <Result result>
void multiply_baseline(int width, const RowProduct& p, const double* x_end) {
  multiply_rows_of<2, result>(width, p, x_end);
}

#if defined(__x86_64__) && defined(__GNUC__)
template <Result result>
[[gnu::target("avx2,fma")]] void multiply_avx2(int width, const RowProduct& p, const double* x_end) {
  multiply_rows_of<4, result>(width, p, x_end);
}

template <Result result>
[[gnu::target("avx512f,avx512vl,fma")]] void multiply_avx512(int width, const RowProduct& p,
                                                             const double* x_end) {
  multiply_rows_of<8, result>(width, p, x_end);
}
#else
template <Result result>
constexpr auto* multiply_avx2 = multiply_baseline<result>;
template <Result result>
constexpr auto* multiply_avx512 = multiply_baseline<result>;
#endif

/// Some columns of x, and as many of y.
struct ColumnRange {
  Eigen::Index of_x, of_y, count;
};

/// Computes y = a·x or y ← y + a·x for some columns. Widths are compile-time constants, so that sums stay in
/// registers. The last bits depend on the instructions.
template <Result result>
void multiply_range(const SparseRows& a, const Columns& x, Columns& y, const ColumnRange& range,
                    const Context& context, platform::VectorInstructions instructions) {
  assert(a.isCompressed());
  if (a.nonZeros() == 0) {  // x may have no rows, and no memory
    if (result == Result::set) y.middleCols(range.of_y, range.count).setZero();
    return;
  }
  const auto kernel = [&] {
    switch (instructions) {
      case platform::VectorInstructions::avx512: return multiply_avx512<result>;
      case platform::VectorInstructions::avx2: return multiply_avx2<result>;
      default: return multiply_baseline<result>;
    }
  }();
  constexpr Eigen::Index entries_at_once = 32'768;
  const std::size_t rows_at_once =
      std::clamp<Eigen::Index>(entries_at_once * a.rows() / std::max<Eigen::Index>(a.nonZeros(), 1), 16, 4096);
  for (Eigen::Index first = 0; first < range.count;) {
    const Eigen::Index left = range.count - first;
    int width = 3;
    if (left != width)
      for (width = 32; width > left || width == 2;) width /= 2;
    parallel_blocks(
        a.rows(),
        [&](std::size_t begin, std::size_t end) {
          kernel(width,
                 {static_cast<Eigen::Index>(begin), static_cast<Eigen::Index>(end), a.outerIndexPtr(),
                  a.innerIndexPtr(), a.valuePtr(), x.data() + range.of_x + first, x.cols(),
                  y.data() + range.of_y + first, y.cols()},
                 x.data() + x.size());
        },
        context, rows_at_once);
    first += width;
  }
}

}  // namespace

Columns multiply(const SparseRows& a, const Columns& x, const Context& context) {
  Columns y;
  multiply(a, x, y, context);
  return y;
}

void multiply(const SparseRows& a, const Columns& x, Columns& y, const Context& context) {
  y.resize(a.rows(), x.cols());
  multiply_columns(a, x, 0, x.cols(), y, 0, context);
}

void multiply_columns(const SparseRows& a, const Columns& x, Eigen::Index first, Eigen::Index count, Columns& y,
                      Eigen::Index at, const Context& context, platform::VectorInstructions instructions) {
  multiply_range<Result::set>(a, x, y, {first, at, count}, context, instructions);
}

void add_product(const SparseRows& a, const Columns& x, Columns& y, const Context& context,
                 platform::VectorInstructions instructions) {
  multiply_range<Result::add>(a, x, y, {0, 0, y.cols()}, context, instructions);
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
