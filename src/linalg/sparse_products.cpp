#include "sparse_products.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "linalg/facts.h"
#include "sparse.h"

namespace meshgraft {

void require_countable(std::int64_t entries) {
  if (entries > std::numeric_limits<int>::max()) throw Error(facts::linalg::OperatorTooLarge{});
}

namespace {

struct SparseRow {
  std::span<const int> columns;
  const double* values;
};

/// Sums sparse rows in a dense array of numbers, or of threes of numbers. Bits tell which columns were touched,
/// so that they are listed in order without sorting them: only the words of 64 bits are sorted, and
/// neighbouring columns share a word.
template <class Value>
class RowAccumulator {
 public:
  explicit RowAccumulator(Eigen::Index columns)
      : values_(columns), bits_(static_cast<std::size_t>(columns) / word_size + 1, 0) {}

  void add(int column, const Value& value) {
    std::uint64_t& word = bits_[static_cast<std::size_t>(column) / word_size];
    const std::uint64_t bit = std::uint64_t{1} << (static_cast<unsigned>(column) % word_size);
    if ((word & bit) != 0) {
      values_[column] += value;
      return;
    }
    if (word == 0) words_.push_back(column / static_cast<int>(word_size));
    word |= bit;
    values_[column] = value;
  }

  /// Appends the touched columns, ascending, and their sums. The next row then starts empty.
  void flush(std::vector<int>& columns, std::vector<Value>& values) {
    std::sort(words_.begin(), words_.end());
    for (const int number : words_) {
      for (std::uint64_t word = bits_[number]; word != 0; word &= word - 1) {
        const int column = number * static_cast<int>(word_size) + std::countr_zero(word);
        columns.push_back(column);
        values.push_back(values_[column]);
      }
      bits_[number] = 0;
    }
    words_.clear();
  }

 private:
  static constexpr std::size_t word_size = 64;
  std::vector<Value> values_;  ///< valid where a bit is set
  std::vector<std::uint64_t> bits_;
  std::vector<int> words_;  ///< numbers of the words with a bit set
};

/// Consecutive rows of b with the same columns, such as those of one vertex's map, are added together. Each
/// entry of the sum is then looked up once for all of them.
constexpr int most_together = 3;

/// Returns for each row the number of rows from it on (at most three) that have the same columns.
Flags rows_alike(const SparseRows& b, const Context& context) {
  const int* outer = b.outerIndexPtr();
  const int* inner = b.innerIndexPtr();
  Flags alike(b.rows(), 1);
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

/// One matrix that others are multiplied by.
struct Factor {
  using Value = double;
  const SparseRows& rows;
  Flags alike;

  Factor(const SparseRows& matrix, const Context& context) : rows(matrix), alike(rows_alike(matrix, context)) {}
  double at(int entry) const { return rows.valuePtr()[entry]; }
};

/// Three matrices with entries at the same places.
struct AlikeFactor {
  using Value = Eigen::Array3d;
  const AlikeRows& matrices;
  const SparseRows& rows;  ///< the first one
  Flags alike;

  AlikeFactor(const AlikeRows& three, const Context& context)
      : matrices(three), rows(three[0]), alike(rows_alike(three[0], context)) {}
  Eigen::Array3d at(int entry) const {
    return {matrices[0].valuePtr()[entry], matrices[1].valuePtr()[entry], matrices[2].valuePtr()[entry]};
  }
};

SparseRow row_of(const SparseRows& matrix, Eigen::Index row) {
  const int begin = matrix.outerIndexPtr()[row], end = matrix.outerIndexPtr()[row + 1];
  return {{matrix.innerIndexPtr() + begin, static_cast<std::size_t>(end - begin)}, matrix.valuePtr() + begin};
}

/// Computes sum += factor · a·b from column `first` on.
template <class AnyFactor>
void add_product(const SparseRow& a, const AnyFactor& b, double factor, int first,
                 RowAccumulator<typename AnyFactor::Value>& sum) {
  const int* outer = b.rows.outerIndexPtr();
  for (std::size_t k = 0; k < a.columns.size();) {
    const int from = a.columns[k];
    std::size_t together = 1;
    while (together < b.alike[from] && k + together < a.columns.size() &&
           a.columns[k + together] == from + static_cast<int>(together))
      ++together;
    const int begin = outer[from], length = outer[from + 1] - begin;
    const int* columns = b.rows.innerIndexPtr();
    const int skip =
        first > 0
            ? static_cast<int>(std::lower_bound(columns + begin, columns + begin + length, first) - columns)
            : begin;
    const double f0 = factor * a.values[k];
    if (together == 3) {
      const double f1 = factor * a.values[k + 1], f2 = factor * a.values[k + 2];
      for (int e = skip; e < begin + length; ++e)
        sum.add(columns[e], f0 * b.at(e) + f1 * b.at(e + length) + f2 * b.at(e + 2 * length));
    } else if (together == 2) {
      const double f1 = factor * a.values[k + 1];
      for (int e = skip; e < begin + length; ++e) sum.add(columns[e], f0 * b.at(e) + f1 * b.at(e + length));
    } else {
      for (int e = skip; e < begin + length; ++e) sum.add(columns[e], f0 * b.at(e));
    }
    k += together;
  }
}

/// Rows of a sum of products, stored in blocks so that no two threads write to the same memory.
template <class Value>
struct ProductRows {
  std::vector<std::int64_t> offsets;            // rows + 1
  std::vector<std::vector<int>> block_columns;  // per block: its rows one after another
  std::vector<std::vector<Value>> block_values;
  static constexpr std::size_t block_size = 256;
};

/// Computes rows of a product: `add_row(row, sum)` adds up a row in `sum`.
template <class Value, class AddRow>
ProductRows<Value> multiply_rows(std::size_t rows, Eigen::Index columns, const AddRow& add_row,
                                 const Context& context) {
  constexpr std::size_t block_size = ProductRows<Value>::block_size;
  const std::size_t blocks = (rows + block_size - 1) / block_size;
  ProductRows<Value> result;
  result.offsets.assign(rows + 1, 0);
  result.block_columns.resize(blocks);
  result.block_values.resize(blocks);
  struct Scratch {
    RowAccumulator<Value> sum;
    std::vector<int> columns;
    std::vector<Value> values;
  };
  tbb::enumerable_thread_specific<Scratch> scratches(
      [&] { return Scratch{RowAccumulator<Value>(columns), {}, {}}; });
  parallel_blocks(
      blocks,
      [&](std::size_t begin, std::size_t end) {
        Scratch& scratch = scratches.local();
        for (std::size_t block = begin; block < end; ++block) {
          scratch.columns.clear();
          scratch.values.clear();
          const std::size_t last = std::min(rows, (block + 1) * block_size);
          for (std::size_t row = block * block_size; row < last; ++row) {
            add_row(static_cast<Eigen::Index>(row), scratch.sum);
            const std::size_t before = scratch.columns.size();
            scratch.sum.flush(scratch.columns, scratch.values);
            result.offsets[row + 1] = static_cast<std::int64_t>(scratch.columns.size() - before);
          }
          result.block_columns[block] = scratch.columns;
          result.block_values[block] = scratch.values;
        }
      },
      context, 1);
  for (std::size_t row = 0; row < rows; ++row) result.offsets[row + 1] += result.offsets[row];
  return result;
}

/// Makes room in a matrix for the entries of a product, and sets where its rows begin.
template <class Value, class Matrix>
void make_room(const ProductRows<Value>& product, Eigen::Index rows, Eigen::Index columns, Matrix& matrix) {
  using StorageIndex = typename Matrix::StorageIndex;
  if constexpr (sizeof(StorageIndex) < sizeof(std::int64_t)) require_countable(product.offsets.back());
  matrix.resize(rows, columns);
  matrix.resizeNonZeros(product.offsets.back());
  std::transform(product.offsets.begin(), product.offsets.end(), matrix.outerIndexPtr(),
                 [](std::int64_t offset) { return static_cast<StorageIndex>(offset); });
}

/// Calls `copy(columns, values, start)` for each block, where `start` is its first entry, and frees the block.
template <class Value, class Copy>
void empty_blocks(ProductRows<Value>&& product, const Context& context, const Copy& copy) {
  parallel_blocks(
      product.block_columns.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) {
          copy(product.block_columns[block], product.block_values[block],
               product.offsets[block * ProductRows<Value>::block_size]);
          std::vector<int>().swap(product.block_columns[block]);
          std::vector<Value>().swap(product.block_values[block]);
        }
      },
      context, 16);
}

/// Moves the blocks into one compressed matrix.
template <typename Matrix>
Matrix compress(ProductRows<double>&& product, Eigen::Index rows, Eigen::Index columns,
                const Context& context) {
  Matrix matrix;
  make_room(product, rows, columns, matrix);
  empty_blocks(std::move(product), context,
               [&](const std::vector<int>& from, const std::vector<double>& values, std::int64_t start) {
                 std::copy(from.begin(), from.end(), matrix.innerIndexPtr() + start);
                 std::copy(values.begin(), values.end(), matrix.valuePtr() + start);
               });
  return matrix;
}

/// Moves the blocks into three matrices.
AlikeRows compress_alike(ProductRows<Eigen::Array3d>&& product, Eigen::Index rows, Eigen::Index columns,
                         const Context& context) {
  AlikeRows matrices;
  for (SparseRows& matrix : matrices) make_room(product, rows, columns, matrix);
  empty_blocks(
      std::move(product), context,
      [&](const std::vector<int>& from, const std::vector<Eigen::Array3d>& values, std::int64_t start) {
        for (int k = 0; k < 3; ++k) {
          std::copy(from.begin(), from.end(), matrices[k].innerIndexPtr() + start);
          std::transform(values.begin(), values.end(), matrices[k].valuePtr() + start,
                         [k](const Eigen::Array3d& value) { return value[k]; });
        }
      });
  return matrices;
}

/// Returns the column of the only entry in each row of b, or -1 in an empty row, if b selects columns: no row
/// and no column has two entries.
std::optional<std::vector<int>> selected_columns(const SparseRows& b) {
  std::vector<int> column_of(b.rows(), -1);
  Flags taken(b.cols(), 0);
  for (Eigen::Index row = 0; row < b.rows(); ++row) {
    const int begin = b.outerIndexPtr()[row], length = b.outerIndexPtr()[row + 1] - begin;
    if (length > 1) return {};
    if (length == 0) continue;
    const int column = b.innerIndexPtr()[begin];
    if (std::exchange(taken[column], std::uint8_t{1}) != 0) return {};
    column_of[row] = column;
  }
  return column_of;
}

/// Computes a·b, where b has at most one entry in each row: the one in `column_of`.
SparseRows multiply_selection(const SparseRows& a, const SparseRows& b, const std::vector<int>& column_of,
                              const Context& context) {
  struct Entry {
    int column, from;
  };
  std::vector<int> lengths(a.rows());
  parallel_blocks(
      lengths.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
          const std::span<const int> columns = row_of(a, static_cast<Eigen::Index>(row)).columns;
          lengths[row] = static_cast<int>(std::count_if(columns.begin(), columns.end(),
                                                        [&](int column) { return column_of[column] >= 0; }));
        }
      },
      context, 4096);
  SparseRows product = rows_of_lengths(lengths, b.cols());
  const Flags alike = rows_alike(a, context);
  parallel_blocks(
      lengths.size(),
      [&](std::size_t begin, std::size_t end) {
        std::vector<Entry> entries;  // of a row of a that keep a column, by their new columns
        std::size_t alike_until = begin;
        for (std::size_t row = begin; row < end; ++row) {
          const auto [columns, values] = row_of(a, static_cast<Eigen::Index>(row));
          if (row >= alike_until) {
            alike_until = row + alike[row];
            entries.clear();
            for (std::size_t k = 0; k < columns.size(); ++k)
              if (const int column = column_of[columns[k]]; column >= 0)
                entries.push_back({column, static_cast<int>(k)});
            std::sort(entries.begin(), entries.end(),
                      [](const Entry& x, const Entry& y) { return x.column < y.column; });
          }
          int at = product.outerIndexPtr()[row];
          for (const auto& [column, from] : entries) {
            product.innerIndexPtr()[at] = column;
            product.valuePtr()[at++] = values[from] * b.valuePtr()[b.outerIndexPtr()[columns[from]]];
          }
        }
      },
      context, 4096);
  return product;
}

}  // namespace

SparseRows multiply(const SparseRows& a, const SparseRows& b, const Context& context) {
  if (const auto column_of = selected_columns(b)) return multiply_selection(a, b, *column_of, context);
  const Factor right(b, context);
  const auto add_row = [&](Eigen::Index row, RowAccumulator<double>& sum) {
    add_product(row_of(a, row), right, 1, 0, sum);
  };
  return compress<SparseRows>(multiply_rows<double>(a.rows(), b.cols(), add_row, context), a.rows(), b.cols(),
                              context);
}

SparseRows difference_of_products(const SparseProduct& first, const SparseProduct& second,
                                  const Context& context) {
  const Factor right1(first.b, context), right2(second.b, context);
  const auto add_row = [&](Eigen::Index row, RowAccumulator<double>& sum) {
    add_product(row_of(first.a, row), right1, 1, 0, sum);
    add_product(row_of(second.a, row), right2, -1, 0, sum);
  };
  const Eigen::Index rows = first.a.rows(), columns = first.b.cols();
  return compress<SparseRows>(multiply_rows<double>(rows, columns, add_row, context), rows, columns, context);
}

namespace {

/// A row of a product that is multiplied further at once, instead of storing it.
class InnerRow {
 public:
  explicit InnerRow(Eigen::Index columns) : sum_(columns) {}

  /// Returns a·b. Its columns ascend, so that the next product finds consecutive rows that are alike.
  SparseRow multiply(const SparseRow& a, const Factor& b) {
    add_product(a, b, 1, 0, sum_);
    columns_.clear();
    values_.clear();
    sum_.flush(columns_, values_);
    return {columns_, values_.data()};
  }

 private:
  RowAccumulator<double> sum_;
  std::vector<int> columns_;
  std::vector<double> values_;
};

}  // namespace

AlikeRows alike_products(const AlikeTerms& terms, const Context& context) {
  const Factor right_b(terms.b, context);
  const AlikeFactor right_c(terms.c, context), right_e(terms.e, context);
  tbb::enumerable_thread_specific<InnerRow> inner([&] { return InnerRow(terms.b.cols()); });
  const auto add_row = [&](Eigen::Index row, RowAccumulator<Eigen::Array3d>& sum) {
    add_product(inner.local().multiply(row_of(terms.a, row), right_b), right_c, 1, 0, sum);
    add_product(row_of(terms.d, row), right_e, -1, 0, sum);
  };
  const Eigen::Index rows = terms.a.rows(), columns = terms.c[0].cols();
  return compress_alike(multiply_rows<Eigen::Array3d>(rows, columns, add_row, context), rows, columns, context);
}

// K G is not stored: it would have more entries than all other matrices.
NormalMatrix normal_equations(const NormalTerms& terms, const Context& context) {
  const Factor right_A(terms.A, context), right_K(terms.K, context), right_G(terms.G, context);
  tbb::enumerable_thread_specific<InnerRow> inner([&] { return InnerRow(terms.K.cols()); });
  // The upper triangle by rows is the lower triangle by columns.
  const auto add_row = [&](Eigen::Index row, RowAccumulator<double>& sum) {
    const auto first = static_cast<int>(row);
    add_product(row_of(terms.A_transposed, row), right_A, 1, first, sum);
    add_product(inner.local().multiply(row_of(terms.G_transposed, row), right_K), right_G, 1, first, sum);
  };
  const Eigen::Index unknowns = terms.A.cols();
  return compress<NormalMatrix>(multiply_rows<double>(unknowns, unknowns, add_row, context), unknowns, unknowns,
                                context);
}

}  // namespace meshgraft
