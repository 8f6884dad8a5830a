#include <meshgraft/linalg/sparse.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <tbb/enumerable_thread_specific.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/parallel.h>

namespace meshgraft {

namespace {

/// Sums sparse rows in a dense array and hands the touched columns out sorted.
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

 private:
  std::vector<double> values_;
  std::vector<std::int64_t> touched_in_;
  std::vector<int> touched_;
  std::int64_t row_ = -1;
};

struct ProductTerm {
  const SparseRows& a;
  const SparseRows& b;
};

/// Rows of Σ a·b, in blocks so that no two threads write to the same place; `first_column(row)` cuts off
/// what lies left of it.
struct ProductRows {
  std::vector<std::int64_t> offsets;            // rows + 1
  std::vector<std::vector<int>> block_columns;  // per block, its rows one after another
  std::vector<std::vector<double>> block_values;
  static constexpr std::size_t block_size = 256;
};

template <typename FirstColumn>
ProductRows multiply_rows(std::span<const ProductTerm> terms, FirstColumn first_column,
                          const Context& context) {
  const auto rows = static_cast<std::size_t>(terms.front().a.rows());
  const Eigen::Index columns = terms.front().b.cols();
  const std::size_t blocks = (rows + ProductRows::block_size - 1) / ProductRows::block_size;
  ProductRows result;
  result.offsets.assign(rows + 1, 0);
  result.block_columns.resize(blocks);
  result.block_values.resize(blocks);
  tbb::enumerable_thread_specific<RowAccumulator> accumulators([columns] { return RowAccumulator(columns); });
  parallel_blocks(
      blocks,
      [&](std::size_t begin, std::size_t end) {
        RowAccumulator& sum = accumulators.local();
        for (std::size_t block = begin; block < end; ++block) {
          auto& out_columns = result.block_columns[block];
          auto& out_values = result.block_values[block];
          const std::size_t last = std::min(rows, (block + 1) * ProductRows::block_size);
          for (std::size_t row = block * ProductRows::block_size; row < last; ++row) {
            const int first = first_column(static_cast<int>(row));
            sum.begin(static_cast<std::int64_t>(row));
            for (const ProductTerm& term : terms) {
              const int* b_outer = term.b.outerIndexPtr();
              const int* b_inner = term.b.innerIndexPtr();
              const double* b_value = term.b.valuePtr();
              for (SparseRows::InnerIterator it(term.a, static_cast<Eigen::Index>(row)); it; ++it) {
                const int* end_of_row = b_inner + b_outer[it.col() + 1];
                const int* entry = b_inner + b_outer[it.col()];
                if (first > 0) entry = std::lower_bound(entry, end_of_row, first);
                for (; entry != end_of_row; ++entry) sum.add(*entry, it.value() * b_value[entry - b_inner]);
              }
            }
            const std::vector<int>& sorted = sum.sorted_columns();
            for (int column : sorted) {
              out_columns.push_back(column);
              out_values.push_back(sum[column]);
            }
            result.offsets[row + 1] = static_cast<std::int64_t>(sorted.size());
          }
        }
      },
      context, 1);
  for (std::size_t row = 0; row < rows; ++row) result.offsets[row + 1] += result.offsets[row];
  return result;
}

/// Moves the blocks into one compressed matrix, freeing each as it goes.
template <typename Matrix>
Matrix compress(ProductRows&& product, Eigen::Index rows, Eigen::Index columns) {
  using StorageIndex = typename Matrix::StorageIndex;
  if (product.offsets.back() > std::numeric_limits<StorageIndex>::max())
    throw Error(ErrorCode::input, "the region is too large: an operator has more than 2^31 non-zeros", "",
                "Choose a smaller region");
  Matrix matrix(rows, columns);
  matrix.resizeNonZeros(product.offsets.back());
  std::transform(product.offsets.begin(), product.offsets.end(), matrix.outerIndexPtr(),
                 [](std::int64_t offset) { return static_cast<StorageIndex>(offset); });
  for (std::size_t block = 0; block < product.block_columns.size(); ++block) {
    const std::int64_t start = product.offsets[block * ProductRows::block_size];
    std::copy(product.block_columns[block].begin(), product.block_columns[block].end(),
              matrix.innerIndexPtr() + start);
    std::copy(product.block_values[block].begin(), product.block_values[block].end(),
              matrix.valuePtr() + start);
    product.block_columns[block] = {};
    product.block_values[block] = {};
  }
  return matrix;
}

}  // namespace

SparseRows multiply(const SparseRows& a, const SparseRows& b, const Context& context) {
  const ProductTerm terms[] = {{a, b}};
  return compress<SparseRows>(multiply_rows(terms, [](int) { return 0; }, context), a.rows(), b.cols());
}

NormalMatrix lower_triangle_of_sum(const SparseRows& a1, const SparseRows& b1, const SparseRows& a2,
                                   const SparseRows& b2, const Context& context) {
  // The upper triangle by rows is the lower one by columns.
  const ProductTerm terms[] = {{a1, b1}, {a2, b2}};
  return compress<NormalMatrix>(
      multiply_rows(terms, [](int row) { return row; }, context), a1.rows(), b1.cols());
}

namespace {

/// Columns [first, first + width) of a·x.
template <int width>
void multiply_columns(const SparseRows& a, const Columns& x, Eigen::Index first, Columns& y,
                      const Context& context) {
  using Row = Eigen::Matrix<double, 1, width>;
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
      context, 4096);
}

}  // namespace

Columns multiply(const SparseRows& a, const Columns& x, const Context& context) {
  // Widths that are known when compiled: sums stay in registers, and nothing is allocated per row.
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
  stacked.reserve(top.nonZeros() + bottom.nonZeros());
  Eigen::Index row = 0;
  for (const SparseRows* part : {&top, &bottom}) {
    for (Eigen::Index r = 0; r < part->rows(); ++r, ++row) {
      stacked.startVec(row);
      for (SparseRows::InnerIterator it(*part, r); it; ++it) stacked.insertBack(row, it.col()) = it.value();
    }
  }
  stacked.finalize();
  return stacked;
}

SparseRows transpose(const SparseRows& a) { return a.transpose(); }

}  // namespace meshgraft
