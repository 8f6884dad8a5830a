#include "block_matrix.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/LU>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "core/sparse_checks.h"
#include "linalg/facts.h"

namespace meshgraft {

namespace {

constexpr int columns = 4;

/// Makes `count` zeros, piece by piece: the first access to a gigabyte takes a quarter of a second.
void set_zero(std::vector<double>& values, std::size_t count, const Context& context) {
  constexpr std::size_t piece = std::size_t{1} << 23;
  values.clear();
  values.reserve(count);
  while (values.size() < count) {
    context.throw_if_stopped();
    values.resize(std::min(count, values.size() + piece), 0.0);
  }
}

/// Numbers in single precision, in a unit.
class Singles {
 public:
  Singles() = default;
  /// Rounds the numbers, in parallel: the first access to the memory takes longer than that.
  Singles(const std::vector<double>& numbers, double unit, const Context& context)
      : values_(new float[numbers.size()]), size_(numbers.size()) {
    parallel_blocks(
        size_,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) values_[k] = static_cast<float>(numbers[k] / unit);
        },
        context, std::size_t{1} << 18);
  }
  const float* data() const { return values_.get(); }
  std::size_t size() const { return size_; }

 private:
  std::unique_ptr<float[]> values_;
  std::size_t size_ = 0;
};

/// The arrays of the matrix that a product or a sweep reads.
template <class Number>
struct Rows {
  double unit;  ///< of the blocks and entries of L
  const Index* block_offsets;
  const Index* block_nodes;
  const Number* blocks;
  const Index* entry_offsets;
  const Index* entry_nodes;
  const Number* entries;
  const double* diagonal;
  const double* diagonal_inverse;
};

// Blocks are arrays of width×width numbers, and a node has values of `width` rows. The compiler unrolls the
// functions below.

/// Computes y += M x.
template <int width, class Number>
[[gnu::always_inline]] inline void add_product(const Number* M, const Four* x, Four* y) {
  for (int a = 0; a < width; ++a)
    for (int b = 0; b < width; ++b) y[a] += double{M[width * a + b]} * x[b];
}

/// Computes y -= Mᵀ x.
template <int width, class Number>
[[gnu::always_inline]] inline void subtract_transposed(const Number* M, const Four* x, Four* y) {
  for (int a = 0; a < width; ++a) {
    Four value = y[a];
    for (int b = 0; b < width; ++b) value -= double{M[width * b + a]} * x[b];
    y[a] = value;
  }
}

/// Computes y += L x in the rows of node i.
template <int width, class Number>
[[gnu::always_inline]] inline void gather(const Rows<Number>& N, Index i, const Four* x, Four* y) {
  for (Index k = N.block_offsets[i]; k < N.block_offsets[i + 1]; ++k)
    add_product<width>(N.blocks + k * std::ptrdiff_t{width * width},
                       x + N.block_nodes[k] * std::ptrdiff_t{width}, y);
  for (Index k = N.entry_offsets[i]; k < N.entry_offsets[i + 1]; ++k)
    y[0] += double{N.entries[k]} * x[N.entry_nodes[k] * std::ptrdiff_t{width}];
}

/// Does the same from the last coupling to the first. A sweep from the last node to the first so reads all
/// arrays in one direction, which the hardware prefetcher needs.
template <int width, class Number>
[[gnu::always_inline]] inline void gather_backward(const Rows<Number>& N, Index i, const Four* x, Four* y) {
  for (Index k = N.entry_offsets[i + 1]; k-- > N.entry_offsets[i];)
    y[0] += double{N.entries[k]} * x[N.entry_nodes[k] * std::ptrdiff_t{width}];
  for (Index k = N.block_offsets[i + 1]; k-- > N.block_offsets[i];)
    add_product<width>(N.blocks + k * std::ptrdiff_t{width * width},
                       x + N.block_nodes[k] * std::ptrdiff_t{width}, y);
}

/// Computes y -= Lᵀ x for the x of node i alone.
template <int width, class Number>
[[gnu::always_inline]] inline void scatter(const Rows<Number>& N, Index i, const Four* x, Four* y) {
  for (Index k = N.block_offsets[i]; k < N.block_offsets[i + 1]; ++k)
    subtract_transposed<width>(N.blocks + k * std::ptrdiff_t{width * width}, x,
                               y + N.block_nodes[k] * std::ptrdiff_t{width});
  for (Index k = N.entry_offsets[i]; k < N.entry_offsets[i + 1]; ++k)
    y[N.entry_nodes[k] * std::ptrdiff_t{width}] -= double{N.entries[k]} * x[0];
}

template <int width>
MESHGRAFT_WIDEST_REGISTERS void multiply_rows(const Rows<double> N, Index begin, Index end, const Four* x,
                                              Four* y) {
  for (Index i = begin; i < end; ++i) {
    const std::ptrdiff_t own = i * std::ptrdiff_t{width};
    Four sum[width] = {}, minus_x[width];
    for (int a = 0; a < width; ++a) minus_x[a] = -x[own + a];
    add_product<width>(N.diagonal + own * width, x + own, sum);
    gather<width>(N, i, x, sum);
    scatter<width>(N, i, minus_x, y);
    for (int a = 0; a < width; ++a) y[own + a] += sum[a];
  }
}

template <int width>
MESHGRAFT_WIDEST_REGISTERS void sweep_rows_forward(const Rows<float> N, Index begin, Index end, const Four* r,
                                                   Four* z, Four* s) {
  for (Index i = begin; i < end; ++i) {
    const std::ptrdiff_t own = i * std::ptrdiff_t{width};
    Four left[width] = {}, solved[width] = {};
    gather<width>(N, i, z, left);
    for (int a = 0; a < width; ++a) left[a] = r[own + a] - N.unit * left[a];
    add_product<width>(N.diagonal_inverse + own * width, left, solved);
    for (int a = 0; a < width; ++a) z[own + a] = solved[a];
    for (int a = 0; a < width; ++a) solved[a] *= N.unit;
    scatter<width>(N, i, solved, s);
  }
}

template <int width>
MESHGRAFT_WIDEST_REGISTERS void sweep_rows_backward(const Rows<float> N, Index begin, Index end, const Four* e,
                                                    Four* s, Four* z) {
  for (Index i = end; i-- > begin;) {
    const std::ptrdiff_t own = i * std::ptrdiff_t{width};
    Four product[width] = {}, change[width];
    gather_backward<width>(N, i, e, product);
    for (int a = 0; a < width; ++a) product[a] *= N.unit;
    add_product<width>(N.diagonal + own * width, e + own, product);
    for (int a = 0; a < width; ++a) {
      product[a] = s[own + a] - product[a];
      change[a] = e[own + a];
    }
    add_product<width>(N.diagonal_inverse + own * width, product, change);
    for (int a = 0; a < width; ++a) z[own + a] += change[a];
    for (int a = 0; a < width; ++a) change[a] *= N.unit;
    scatter<width>(N, i, change, s);
  }
}

void set_zero(FourColumns& x, Eigen::Index rows, const Context& context) {
  x.resize(rows, columns);
  parallel_blocks(
      rows,
      [&](std::size_t begin, std::size_t end) {
        std::fill(x.data() + begin * columns, x.data() + end * columns, 0.0);
      },
      context, 65536);
}

template <int width>
class BlockMatrixOf final : public BlockMatrix {
 public:
  using Block = Eigen::Matrix<double, width, width, Eigen::RowMajor>;

  explicit BlockMatrixOf(const NodeOrder& order) : order_(order) {}

  void set_values(const NormalMatrix& lower, const Context& context) override {
    const std::vector<int>& row = order_.nodes.row;
    set_zero(blocks_, order_.before_by_block.values.size() * block_size, context);
    set_zero(entries_, order_.before_by_entry.values.size(), context);
    diagonal_.assign(order_.nodes.count * block_size, 0.0);
    parallel_blocks(
        lower.cols(),
        [&](std::size_t begin, std::size_t end) {
          for (auto column = static_cast<Eigen::Index>(begin); column < static_cast<Eigen::Index>(end);
               ++column) {
            ColumnWriter writer(*this, row[column]);
            for (NormalMatrix::InnerIterator entry(lower, column); entry; ++entry)
              writer.set(row[entry.row()], entry.value());
          }
        },
        context, 2048);
    for (std::size_t r = 0; r < order_.nodes.unknown.size(); ++r)
      if (order_.nodes.unknown[r] < 0) diagonal_[r / width * block_size + r % width * (width + 1)] = 1;
    invert_diagonal(lower.rows(), context);
  }

  void prepare_sweeps(const Context& context) override {
    // No entry of a positive definite matrix is larger than those of its diagonal.
    double largest = 0;
    for (std::size_t r = 0; r < order_.nodes.unknown.size(); ++r)
      if (order_.nodes.unknown[r] >= 0)
        largest = std::max(largest, diagonal_[r / width * block_size + r % width * (width + 1)]);
    unit_ = largest > 0 ? std::ldexp(1.0, std::ilogb(largest)) : 1;
    blocks_for_sweeps_ = Singles(blocks_, unit_, context);
    entries_for_sweeps_ = Singles(entries_, unit_, context);
  }

  void multiply(const FourColumns& x, FourColumns& y, const Context& context) const override {
    set_zero(y, x.rows(), context);
    for (const int parity : {0, 1})
      for_each_strip(parity, context, [&](Index begin, Index end) {
        multiply_rows<width>(rows_for_products(), begin, end, rows_of(x), rows_of(y));
      });
  }

  void sweep_forward(const FourColumns& r, FourColumns& z, FourColumns& s,
                     const Context& context) const override {
    z.resize(r.rows(), columns);
    set_zero(s, r.rows(), context);
    for (const int parity : {0, 1})
      for_each_strip(parity, context, [&](Index begin, Index end) {
        sweep_rows_forward<width>(rows_for_sweeps(), begin, end, rows_of(r), rows_of(z), rows_of(s));
      });
  }

  void sweep_backward(const FourColumns& e, FourColumns& s, FourColumns& z,
                      const Context& context) const override {
    for (const int parity : {1, 0})
      for_each_strip(parity, context, [&](Index begin, Index end) {
        sweep_rows_backward<width>(rows_for_sweeps(), begin, end, rows_of(e), rows_of(s), rows_of(z));
      });
  }

  std::int64_t bytes() const override {
    const std::size_t numbers = blocks_.size() + entries_.size() + diagonal_.size() + diagonal_inverse_.size();
    const std::size_t singles = blocks_for_sweeps_.size() + entries_for_sweeps_.size();
    const std::size_t indices = order_.before_by_block.values.size() + order_.before_by_entry.values.size();
    return static_cast<std::int64_t>(numbers * sizeof(double) + singles * sizeof(float) +
                                     indices * sizeof(Index));
  }

  const double* diagonal_block(Index node) const override { return &diagonal_[node * block_size]; }
  const double* blocks_before(Index node) const override {
    return blocks_.data() + order_.before_by_block.offsets[node] * block_size;
  }
  const double* entries_before(Index node) const override {
    return entries_.data() + order_.before_by_entry.offsets[node];
  }

 private:
  static constexpr std::size_t block_size = width * width;

  template <class Number>
  Rows<Number> rows_with(const Number* blocks, const Number* entries, double unit) const {
    const IndexLists &by_block = order_.before_by_block, &by_entry = order_.before_by_entry;
    return {unit,    by_block.offsets.data(), by_block.values.data(),
            blocks,  by_entry.offsets.data(), by_entry.values.data(),
            entries, diagonal_.data(),        diagonal_inverse_.data()};
  }
  Rows<double> rows_for_products() const { return rows_with(blocks_.data(), entries_.data(), 1); }
  Rows<float> rows_for_sweeps() const {
    return rows_with(blocks_for_sweeps_.data(), entries_for_sweeps_.data(), unit_);
  }

  template <class Body>
  void for_each_strip(int parity, const Context& context, const Body& body) const {
    const std::vector<Index>& begin = order_.strips.begin;
    const Index count = (order_.strips.size() + 1 - parity) / 2;
    parallel_blocks(
        count,
        [&](std::size_t first, std::size_t last) {
          for (std::size_t k = first; k < last; ++k) body(begin[2 * k + parity], begin[2 * k + parity + 1]);
        },
        context, 1);
  }

  /// Writes the entries of one column, each into the coupling of its two nodes. A block stored for the
  /// opposite order of the nodes is transposed.
  class ColumnWriter {
   public:
    ColumnWriter(BlockMatrixOf& matrix, int column)
        : matrix_(matrix), node_(column / width), at_(column % width) {}

    void set(int row, double value) {
      const int at = row % width;
      if (row / width != other_) look_up(row / width);
      if (other_ == node_)
        block_[at_ * width + at] = block_[at * width + at_] = value;
      else if (entry_ != nullptr)
        *entry_ = value;
      else
        block_[transposed_ ? at_ * width + at : at * width + at_] = value;
    }

   private:
    void look_up(Index node) {
      const NodeOrder& order = matrix_.order_;
      other_ = node;
      entry_ = nullptr;
      transposed_ = false;
      if (node == node_) {
        block_ = &matrix_.diagonal_[node * block_size];
      } else if (std::size_t k = find(order.before_by_block, node, node_); k != none) {
        block_ = &matrix_.blocks_[k * block_size];
      } else if (k = find(order.before_by_block, node_, node); k != none) {
        block_ = &matrix_.blocks_[k * block_size];
        transposed_ = true;
      } else {
        k = find(order.before_by_entry, node, node_);
        if (k == none) k = find(order.before_by_entry, node_, node);
        entry_ = &matrix_.entries_[k];
      }
    }

    static constexpr std::size_t none = static_cast<std::size_t>(-1);
    static std::size_t find(const IndexLists& lists, Index node, Index other) {
      const auto list = lists[node];
      const auto at = std::lower_bound(list.begin(), list.end(), other);
      if (at == list.end() || *at != other) return none;
      return lists.offsets[node] + (at - list.begin());
    }

    BlockMatrixOf& matrix_;
    const Index node_;
    const int at_;
    Index other_ = -1;
    bool transposed_ = false;
    double *block_ = nullptr, *entry_ = nullptr;
  };

  void invert_diagonal(Eigen::Index unknowns, const Context& context) {
    SparseChecks check(context);
    diagonal_inverse_.resize(diagonal_.size());
    for (Index node = 0; node < order_.nodes.count; ++node) {
      check();
      const Block block = Eigen::Map<const Block>(&diagonal_[node * block_size]);
      const Eigen::LLT<Block> cholesky(block);
      if (cholesky.info() != Eigen::Success)
        throw Error(facts::linalg::NotPositiveDefinite{
            .count = unknowns, .at = std::array{order_.nodes.unknown[static_cast<std::size_t>(node) * width]}});
      Eigen::Map<Block> inverse(&diagonal_inverse_[node * block_size]);
      inverse = block.inverse();
    }
  }

  const NodeOrder& order_;
  std::vector<double> blocks_, entries_, diagonal_, diagonal_inverse_;
  double unit_ = 1;  ///< of L for sweeps, a power of two
  Singles blocks_for_sweeps_, entries_for_sweeps_;
};

}  // namespace

std::unique_ptr<BlockMatrix> make_block_matrix(const NodeOrder& order) {
  if (order.nodes.width == 1) return std::make_unique<BlockMatrixOf<1>>(order);
  return std::make_unique<BlockMatrixOf<2>>(order);
}

}  // namespace meshgraft
