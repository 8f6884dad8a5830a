#include <meshgraft/linalg/sparse.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/parallel.h>

#include "linalg/facts.h"

namespace meshgraft {

namespace {

struct SparseRow {
  std::span<const int> columns;
  const double* values;
};

void require_countable(std::int64_t entries) {
  if (entries > std::numeric_limits<int>::max()) throw Error(facts::linalg::OperatorTooLarge{});
}

/// Sums sparse rows in a dense array. Returns the touched columns sorted.
class RowAccumulator {
 public:
  explicit RowAccumulator(Eigen::Index columns) : values_(columns, 0.0), touched_in_(columns, -1) {}

  void begin(std::int64_t row) {
    row_ = row;
    touched_.clear();
  }
  void add(int column, double value) {
    if (touched_in_[column] != row_) {
      touched_in_[column] = row_;
      values_[column] = value;
      touched_.push_back(column);
    } else {
      values_[column] += value;
    }
  }
  const std::vector<int>& sorted_columns() {
    std::sort(touched_.begin(), touched_.end());
    return touched_;
  }
  double operator[](int column) const { return values_[column]; }
  /// Returns a sparse row whose columns are in the order in which they were first touched.
  SparseRow row() {
    gathered_.clear();
    for (const int column : touched_) gathered_.push_back(values_[column]);
    return {touched_, gathered_.data()};
  }

 private:
  std::vector<double> values_, gathered_;
  std::vector<std::int64_t> touched_in_;
  std::vector<int> touched_;
  std::int64_t row_ = -1;
};

/// Consecutive rows of b with the same columns, such as those of one vertex's map, are added together. Each
/// entry of the sum is then looked up once for all of them.
constexpr int most_together = 3;

/// Returns for each row the number of rows from it on (at most three) that have the same columns.
Flags rows_alike(const SparseRows& b, const Context& context) {
  const int* outer = b.outerIndexPtr();
  const int* inner = b.innerIndexPtr();
  Flags alike(static_cast<std::size_t>(b.rows()), 1);
  parallel_blocks(
      alike.size(),
      [&](std::size_t begin, std::size_t end) {
        for (auto row = static_cast<Eigen::Index>(begin); row < static_cast<Eigen::Index>(end); ++row) {
          Eigen::Index next = row + 1;
          while (next < b.rows() && next < row + most_together &&
                 std::equal(inner + outer[row], inner + outer[row + 1], inner + outer[next],
                            inner + outer[next + 1]))
            ++next;
          alike[row] = static_cast<std::uint8_t>(next - row);
        }
      },
      context, 4096);
  return alike;
}

struct Factor {
  const SparseRows& rows;
  Flags alike;

  Factor(const SparseRows& matrix, const Context& context) : rows(matrix), alike(rows_alike(matrix, context)) {}
};

SparseRow row_of(const SparseRows& matrix, Eigen::Index row) {
  const int begin = matrix.outerIndexPtr()[row], end = matrix.outerIndexPtr()[row + 1];
  return {{matrix.innerIndexPtr() + begin, static_cast<std::size_t>(end - begin)}, matrix.valuePtr() + begin};
}

/// Computes sum += factor · a·b from column `first` on.
void add_product(const SparseRow& a, const Factor& b, double factor, int first, RowAccumulator& sum) {
  const int* outer = b.rows.outerIndexPtr();
  for (std::size_t k = 0; k < a.columns.size();) {
    const int from = a.columns[k];
    std::size_t together = 1;
    while (together < b.alike[from] && k + together < a.columns.size() &&
           a.columns[k + together] == from + static_cast<int>(together))
      ++together;
    const int begin = outer[from], length = outer[from + 1] - begin;
    const int* columns = b.rows.innerIndexPtr() + begin;
    const double* v = b.rows.valuePtr() + begin;
    const int skip =
        first > 0 ? static_cast<int>(std::lower_bound(columns, columns + length, first) - columns) : 0;
    const double f0 = factor * a.values[k];
    if (together == 3) {
      const double f1 = factor * a.values[k + 1], f2 = factor * a.values[k + 2];
      for (int e = skip; e < length; ++e)
        sum.add(columns[e], f0 * v[e] + f1 * v[e + length] + f2 * v[e + 2 * length]);
    } else if (together == 2) {
      const double f1 = factor * a.values[k + 1];
      for (int e = skip; e < length; ++e) sum.add(columns[e], f0 * v[e] + f1 * v[e + length]);
    } else {
      for (int e = skip; e < length; ++e) sum.add(columns[e], f0 * v[e]);
    }
    k += together;
  }
}

/// Rows of a sum of products, stored in blocks so that no two threads write to the same memory.
struct ProductRows {
  std::vector<std::int64_t> offsets;            // rows + 1
  std::vector<std::vector<int>> block_columns;  // per block: its rows one after another
  std::vector<std::vector<double>> block_values;
  static constexpr std::size_t block_size = 256;
};

/// Computes rows of a product: `add_row(row, sum, inner)` adds up a row in `sum`. `inner` is a second
/// accumulator for intermediate sums.
template <typename AddRow>
ProductRows multiply_rows(std::size_t rows, Eigen::Index columns, Eigen::Index inner_columns,
                          const AddRow& add_row, const Context& context) {
  const std::size_t blocks = (rows + ProductRows::block_size - 1) / ProductRows::block_size;
  ProductRows result;
  result.offsets.assign(rows + 1, 0);
  result.block_columns.resize(blocks);
  result.block_values.resize(blocks);
  struct Scratch {
    RowAccumulator sum, inner;
    std::vector<int> columns;
    std::vector<double> values;
  };
  tbb::enumerable_thread_specific<Scratch> scratches(
      [&] { return Scratch{RowAccumulator(columns), RowAccumulator(inner_columns), {}, {}}; });
  parallel_blocks(
      blocks,
      [&](std::size_t begin, std::size_t end) {
        Scratch& scratch = scratches.local();
        for (std::size_t block = begin; block < end; ++block) {
          scratch.columns.clear();
          scratch.values.clear();
          const std::size_t last = std::min(rows, (block + 1) * ProductRows::block_size);
          for (std::size_t row = block * ProductRows::block_size; row < last; ++row) {
            scratch.sum.begin(static_cast<std::int64_t>(row));
            add_row(static_cast<Eigen::Index>(row), scratch.sum, scratch.inner);
            const std::vector<int>& sorted = scratch.sum.sorted_columns();
            for (const int column : sorted) {
              scratch.columns.push_back(column);
              scratch.values.push_back(scratch.sum[column]);
            }
            result.offsets[row + 1] = static_cast<std::int64_t>(sorted.size());
          }
          result.block_columns[block] = scratch.columns;
          result.block_values[block] = scratch.values;
        }
      },
      context, 1);
  for (std::size_t row = 0; row < rows; ++row) result.offsets[row + 1] += result.offsets[row];
  return result;
}

/// Moves the blocks into one compressed matrix and frees each block once it is copied.
template <typename Matrix>
Matrix compress(ProductRows&& product, Eigen::Index rows, Eigen::Index columns, const Context& context) {
  using StorageIndex = typename Matrix::StorageIndex;
  if constexpr (sizeof(StorageIndex) < sizeof(std::int64_t)) require_countable(product.offsets.back());
  Matrix matrix(rows, columns);
  matrix.resizeNonZeros(product.offsets.back());
  std::transform(product.offsets.begin(), product.offsets.end(), matrix.outerIndexPtr(),
                 [](std::int64_t offset) { return static_cast<StorageIndex>(offset); });
  parallel_blocks(
      product.block_columns.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
          const std::int64_t start = product.offsets[block * ProductRows::block_size];
          std::copy(product.block_columns[block].begin(), product.block_columns[block].end(),
                    matrix.innerIndexPtr() + start);
          std::copy(product.block_values[block].begin(), product.block_values[block].end(),
                    matrix.valuePtr() + start);
          product.block_columns[block] = {};
          product.block_values[block] = {};
        }
      },
      context, 16);
  return matrix;
}

}  // namespace

SparseRows multiply(const SparseRows& a, const SparseRows& b, const Context& context) {
  const Factor right(b, context);
  return compress<SparseRows>(multiply_rows(
                                  static_cast<std::size_t>(a.rows()), b.cols(), 0,
                                  [&](Eigen::Index row, RowAccumulator& sum, RowAccumulator&) {
                                    add_product(row_of(a, row), right, 1, 0, sum);
                                  },
                                  context),
                              a.rows(), b.cols(), context);
}

SparseRows difference_of_products(const SparseRows& a1, const SparseRows& b1, const SparseRows& a2,
                                  const SparseRows& b2, const Context& context) {
  const Factor right1(b1, context), right2(b2, context);
  return compress<SparseRows>(multiply_rows(
                                  static_cast<std::size_t>(a1.rows()), b1.cols(), 0,
                                  [&](Eigen::Index row, RowAccumulator& sum, RowAccumulator&) {
                                    add_product(row_of(a1, row), right1, 1, 0, sum);
                                    add_product(row_of(a2, row), right2, -1, 0, sum);
                                  },
                                  context),
                              a1.rows(), b1.cols(), context);
}

NormalMatrix normal_equations(const SparseRows& A_transposed, const SparseRows& A,
                              const SparseRows& G_transposed, const SparseRows& K, const SparseRows& G,
                              const Context& context) {
  const Factor right_A(A, context), right_K(K, context), right_G(G, context);
  // The upper triangle by rows is the lower triangle by columns.
  return compress<NormalMatrix>(multiply_rows(
                                    static_cast<std::size_t>(A.cols()), A.cols(), K.cols(),
                                    [&](Eigen::Index row, RowAccumulator& sum, RowAccumulator& inner) {
                                      const auto first = static_cast<int>(row);
                                      add_product(row_of(A_transposed, row), right_A, 1, first, sum);
                                      inner.begin(row);
                                      add_product(row_of(G_transposed, row), right_K, 1, 0, inner);
                                      add_product(inner.row(), right_G, 1, first, sum);
                                    },
                                    context),
                                A.cols(), A.cols(), context);
}

namespace {

/// Computes columns [first, first + width) of a·x.
template <int width>
void multiply_columns(const SparseRows& a, const Columns& x, Eigen::Index first, Columns& y,
                      const Context& context) {
  using Row = Eigen::Matrix<double, 1, width>;
  constexpr Eigen::Index entries_at_once = 32'768;
  const auto rows_at_once = static_cast<std::size_t>(
      std::clamp<Eigen::Index>(entries_at_once * a.rows() / std::max<Eigen::Index>(a.nonZeros(), 1), 16, 4096));
  parallel_blocks(
      static_cast<std::size_t>(a.rows()),
      [&](std::size_t begin, std::size_t end) {
        for (auto row = static_cast<Eigen::Index>(begin); row < static_cast<Eigen::Index>(end); ++row) {
          Row sum = Row::Zero();
          for (SparseRows::InnerIterator it(a, row); it; ++it)
            sum += it.value() * x.row(it.col()).template segment<width>(first);
          y.row(row).template segment<width>(first) = sum;
        }
      },
      context, rows_at_once);
}

}  // namespace

Columns multiply(const SparseRows& a, const Columns& x, const Context& context) {
  // Widths are compile-time constants, so that sums stay in registers and no row allocates memory.
  Columns y(a.rows(), x.cols());
  Eigen::Index first = 0;
  while (const Eigen::Index left = x.cols() - first) {
    if (left == 3) {
      multiply_columns<3>(a, x, first, y, context);
      first += 3;
    } else if (left >= 8) {
      multiply_columns<8>(a, x, first, y, context);
      first += 8;
    } else if (left >= 4) {
      multiply_columns<4>(a, x, first, y, context);
      first += 4;
    } else {
      multiply_columns<1>(a, x, first, y, context);
      first += 1;
    }
  }
  return y;
}

SparseRows stack(const SparseRows& top, const SparseRows& bottom) {
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
    inner = std::copy_n(part->innerIndexPtr(), count, inner);
    values = std::copy_n(part->valuePtr(), count, values);
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
          for (Eigen::Index row = 0; row < a.rows(); ++row)
            for (SparseRows::InnerIterator it(a, row); it; ++it)
              if (it.col() >= first && it.col() < last) body(static_cast<int>(row), it);
        },
        context);
  };
  for_each_entry([&](int, const SparseRows::InnerIterator& it) { ++outer[it.col() + 1]; });
  std::partial_sum(outer, outer + a.cols() + 1, outer);
  std::vector<int> next(outer, outer + a.cols());
  for_each_entry([&](int row, const SparseRows::InnerIterator& it) {
    const int entry = next[static_cast<std::size_t>(it.col())]++;
    transposed.innerIndexPtr()[entry] = row;
    transposed.valuePtr()[entry] = it.value();
  });
  return transposed;
}

}  // namespace meshgraft
