#include "multifrontal.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <new>
#include <thread>
#include <utility>

#include <tbb/enumerable_thread_specific.h>

#include <meshgraft/core/error.h>

#include "dense_cholesky.h"
#include "linalg/blas_threads.h"
#include "linalg/facts.h"
#include "narrow_solve.h"
#include "wide_solve.h"

namespace meshgraft {

namespace {

double* allocate_doubles(std::int64_t count) {
  void* const memory = std::malloc(static_cast<std::size_t>(count) * sizeof(double));
  if (memory == nullptr && count > 0) throw std::bad_alloc();
  return static_cast<double*>(memory);
}

/// Returns the parent of each supernode, or -1 at roots. The parent contains the supernode's first row below
/// its own.
std::vector<int> parents(const SupernodalPattern& pattern) {
  std::vector<int> node_at(pattern.order.size()), parent;
  for (int node = 0; node < pattern.supernodes(); ++node)
    std::fill(node_at.begin() + pattern.first_position[node],
              node_at.begin() + pattern.first_position[node + 1], node);
  for (int node = 0; node < pattern.supernodes(); ++node) {
    const std::int64_t below =
        pattern.rows_begin[node] + pattern.first_position[node + 1] - pattern.first_position[node];
    parent.push_back(below < pattern.rows_begin[node + 1] ? node_at[pattern.rows[below]] : -1);
  }
  return parent;
}

/// Estimates the operations per supernode.
std::vector<double> work(const SupernodalPattern& pattern) {
  std::vector<double> operations;
  for (int node = 0; node < pattern.supernodes(); ++node) {
    const double columns = pattern.first_position[node + 1] - pattern.first_position[node],
                 rows = static_cast<double>(pattern.rows_begin[node + 1] - pattern.rows_begin[node]),
                 below = rows - columns;
    operations.push_back(columns * (columns * columns / 3 + columns * below + below * below + 100 * rows));
  }
  return operations;
}

/// A pool of memory for update matrices. Reuse avoids the cost of touching fresh pages.
class UpdateStore {
 public:
  struct Block {
    std::unique_ptr<double[]> values;
    std::int64_t size = 0;
  };

  Block take(std::int64_t size) {
    const std::lock_guard lock(mutex_);
    auto fitting = free_.lower_bound(size);
    if (fitting != free_.end() && fitting->first > 2 * size + 10'000) fitting = free_.end();
    if (fitting == free_.end()) {
      // Frees the largest of the blocks that are too small before the allocation, because sizes grow up the
      // tree.
      if (auto smaller = free_.lower_bound(size); smaller != free_.begin()) {
        --smaller;
        total_ -= smaller->first;
        free_.erase(smaller);
      }
      total_ += size;
      peak_ = std::max(peak_, total_);
      return {std::unique_ptr<double[]>(new double[size]), size};
    }
    Block block{std::move(fitting->second), fitting->first};
    free_.erase(fitting);
    return block;
  }

  void give_back(Block block) {
    if (block.size == 0) return;
    const std::lock_guard lock(mutex_);
    free_.emplace(block.size, std::move(block.values));
  }

  std::int64_t peak() const { return peak_; }

 private:
  std::mutex mutex_;
  std::multimap<std::int64_t, std::unique_ptr<double[]>> free_;
  std::int64_t total_ = 0, peak_ = 0;
};

}  // namespace

struct MultifrontalFactor::Front {
  int first = 0, columns = 0, rows = 0;
  const int* positions = nullptr;  ///< of its rows
  double* panel = nullptr;         ///< rows×columns, column-major

  int below() const { return rows - columns; }
  std::int64_t update_size() const { return static_cast<std::int64_t>(below()) * below(); }
};

MultifrontalFactor::Front MultifrontalFactor::front(int node) const {
  const int first = pattern_.first_position[node];
  return {first, pattern_.first_position[node + 1] - first,
          static_cast<int>(pattern_.rows_begin[node + 1] - pattern_.rows_begin[node]),
          pattern_.rows.data() + pattern_.rows_begin[node],
          values_ == nullptr ? nullptr : values_.get() + panel_begin_[node]};
}

MultifrontalFactor::MultifrontalFactor(SupernodalPattern pattern)
    : pattern_(std::move(pattern)),
      inverse_permutation_(pattern_.order.size()),
      parent_(parents(pattern_)),
      panel_begin_(1, 0),
      children_(parent_.size()),
      forest_(parent_, work(pattern_)) {
  for (std::size_t p = 0; p < inverse_permutation_.size(); ++p)
    inverse_permutation_[pattern_.order[p]] = static_cast<int>(p);
  for (int node = 0; node < pattern_.supernodes(); ++node) {
    const Front f = front(node);
    panel_begin_.push_back(panel_begin_.back() + static_cast<std::int64_t>(f.rows) * f.columns);
    if (parent_[node] >= 0) children_[parent_[node]].push_back(node);
  }
}

/// The data of one factorisation.
struct MultifrontalFactor::Elimination {
  LowerEntries entries;
  UpdateStore store;
  std::vector<UpdateStore::Block> updates;  ///< per supernode, until its parent has added it
};

/// Copies the supernode's columns of the matrix to the panel. `row_at` gives the front's row of a position.
void MultifrontalFactor::gather_panel(const Front& f, const LowerEntries& entries,
                                      const std::vector<int>& row_at) const {
  std::fill_n(f.panel, static_cast<std::int64_t>(f.rows) * f.columns, 0.0);
  for (int c = 0; c < f.columns; ++c)
    for (std::int64_t e = entries.begin[f.first + c]; e < entries.begin[f.first + c + 1]; ++e)
      f.panel[row_at[entries.row[e]] + static_cast<std::int64_t>(c) * f.rows] = entries.value[e];
}

/// Adds the columns of the children's updates that fall into columns [from, to) of the front to `target`.
/// `target` holds the front's rows and columns from `shift` on, with `stride` rows per column.
void MultifrontalFactor::add_updates(int node, int from, int to, const std::vector<int>& row_at,
                                     const Elimination& elimination, double* target, int shift,
                                     int stride) const {
  std::vector<int> rows;
  for (const int child : children_[node]) {
    const Front g = front(child);
    const double* update = elimination.updates[child].values.get();
    const int below = g.below();
    rows.resize(below);
    for (int r = 0; r < below; ++r) rows[r] = row_at[g.positions[g.columns + r]];
    const auto begin = static_cast<int>(std::lower_bound(rows.begin(), rows.end(), from) - rows.begin()),
               end = static_cast<int>(std::lower_bound(rows.begin(), rows.end(), to) - rows.begin());
    for (int c = begin; c < end; ++c) {
      double* out = target + static_cast<std::int64_t>(rows[c] - shift) * stride - shift;
      const double* in = update + static_cast<std::int64_t>(c) * below;
      for (int r = c; r < below; ++r) out[rows[r]] += in[r];
    }
  }
}

/// Eliminates a supernode. The children's updates in the panel are added before its factorisation, the others
/// after the front's own update is formed.
void MultifrontalFactor::eliminate(int node, std::vector<int>& row_at, Elimination& elimination,
                                   const Context& context) const {
  const Front f = front(node);
  for (int r = 0; r < f.rows; ++r) row_at[f.positions[r]] = r;
  gather_panel(f, elimination.entries, row_at);
  add_updates(node, 0, f.columns, row_at, elimination, f.panel, 0, f.rows);
  const int good = factorise_panel(f.panel, f.rows, f.columns, context);
  if (good < f.columns)
    throw Error(facts::linalg::NotPositiveDefinite{.count = pattern_.order.size(),
                                                   .at = std::array{pattern_.order[f.first + good]}});
  if (f.below() > 0) {
    UpdateStore::Block& update = elimination.updates[node];
    update = elimination.store.take(f.update_size());
    form_update(f.panel, f.rows, f.columns, update.values.get(), context);
    add_updates(node, f.columns, f.rows, row_at, elimination, update.values.get(), f.columns, f.below());
  }
  for (const int child : children_[node]) elimination.store.give_back(std::move(elimination.updates[child]));
}

LowerEntries MultifrontalFactor::permuted(const NormalMatrix& lower, const Context& context) const {
  return permute(lower, inverse_permutation_, true, context);
}

void MultifrontalFactor::factorise(LowerEntries entries, const Context& context) {
  const SingleThreadedBlas single_threaded(context);
  Elimination elimination{.entries = std::move(entries), .store = {}, .updates = {}};
  elimination.updates.resize(parent_.size());
  rounded_.reset();
  values_.reset(allocate_doubles(panel_begin_.back()));
  const auto unknowns = static_cast<double>(pattern_.order.size());
  std::atomic<std::int64_t> eliminated = 0;
  tbb::enumerable_thread_specific<std::vector<int>> row_maps(
      [&] { return std::vector<int>(pattern_.order.size()); });
  const auto caller = std::this_thread::get_id();
  forest_.visit_up(
      [&](int node) {
        eliminate(node, row_maps.local(), elimination, context);
        eliminated += front(node).columns;
        if (std::this_thread::get_id() == caller)
          context.step("factorise", static_cast<double>(eliminated) / unknowns);
      },
      context);
  peak_bytes_ = static_cast<std::int64_t>(sizeof(double)) * (panel_begin_.back() + elimination.store.peak()) +
                static_cast<std::int64_t>(sizeof(int)) * static_cast<std::int64_t>(pattern_.rows.size());
}

/// Returns whether the factor has no number beyond the range of single precision, and no diagonal below it.
bool MultifrontalFactor::is_within_singles() const {
  constexpr double least = 1e-30, most = 1e30;
  for (int node = 0; node < pattern_.supernodes(); ++node) {
    const Front f = front(node);
    for (int c = 0; c < f.columns; ++c)
      if (!(f.panel[static_cast<std::int64_t>(c) * (f.rows + 1)] > least)) return false;
  }
  return std::all_of(values_.get(), values_.get() + panel_begin_.back(),
                     [](double value) { return std::abs(value) < most; });
}

// Rounds in place, because the first access to other memory would take longer.
void MultifrontalFactor::round() {
  const std::int64_t count = panel_begin_.back();
  if (count == 0 || !is_within_singles()) return;
  void* const memory = values_.release();
  for (std::int64_t k = 0; k < count; ++k) {
    double value = 0;
    std::memcpy(&value, static_cast<const double*>(memory) + k, sizeof value);
    const auto rounded = static_cast<float>(value);
    std::memcpy(static_cast<float*>(memory) + k, &rounded, sizeof rounded);
  }
  void* const shrunk = std::realloc(memory, static_cast<std::size_t>(count) * sizeof(float));
  rounded_.reset(static_cast<float*>(shrunk != nullptr ? shrunk : memory));
}

Eigen::MatrixXd MultifrontalFactor::solve(const Eigen::MatrixXd& rhs, const Context& context) const {
  LinearSolver::Rows x = rhs;
  solve_in_place(x, context);
  return x;
}

namespace {

// How a front stores its right-hand sides, and the kernels for that.

/// Column by column, for few right-hand sides.
struct NarrowLayout {
  int width;

  std::int64_t size(int rows) const { return static_cast<std::int64_t>(rows) * width; }
  std::int64_t at(int rows, int row, int column) const {
    return row + static_cast<std::int64_t>(column) * rows;
  }
  template <class Number>
  void solve(const Number* panel, int rows, int columns, double* x) const {
    solve_narrow_panel(panel, rows, columns, x, width);
  }
  template <class Number>
  void solve_transposed(const Number* panel, int rows, int columns, double* x) const {
    solve_narrow_panel_transposed(panel, rows, columns, x, width);
  }
};

/// Row by row, for many. Rows are padded with numbers that no other column reads.
struct WideLayout {
  int width;

  std::int64_t size(int rows) const { return static_cast<std::int64_t>(rows) * wide_columns; }
  std::int64_t at(int, int row, int column) const {
    return static_cast<std::int64_t>(row) * wide_columns + column;
  }
  void solve(const double* panel, int rows, int columns, double* x) const {
    solve_wide_panel(panel, rows, columns, x);
  }
  void solve_transposed(const double* panel, int rows, int columns, double* x) const {
    solve_wide_panel_transposed(panel, rows, columns, x);
  }
};

}  // namespace

void MultifrontalFactor::solve_in_place(LinearSolver::Rows& x, const Context& context) const {
  if (x.rows() == 0) return;
  constexpr int few =
      12;  // The narrow kernel takes six at a time: twelve take it as long as up to 32 take the wide one.
  for (Eigen::Index begin = 0; begin < x.cols(); begin += wide_columns) {
    const auto width = static_cast<int>(std::min<Eigen::Index>(wide_columns, x.cols() - begin));
    if (rounded_)
      substitute(x.middleCols(begin, width), NarrowLayout{width}, rounded_.get(), context);
    else if (width <= few)
      substitute(x.middleCols(begin, width), NarrowLayout{width}, values_.get(), context);
    else
      substitute(x.middleCols(begin, width), WideLayout{width}, values_.get(), context);
  }
}

/// Computes x ← P L⁻ᵀ L⁻¹ Pᵀ x. A front reads all right-hand sides of an unknown at once, because x is stored
/// row by row. The way up leaves out subtrees where all right-hand sides are zero.
template <class Layout, class Number>
void MultifrontalFactor::substitute(Eigen::Ref<LinearSolver::Rows> x, const Layout& layout,
                                    const Number* panels, const Context& context) const {
  const int width = layout.width;
  const auto read_row = [&](int position, const Front& f, int row, double* values) {
    const double* from = &x(pattern_.order[position], 0);
    for (int c = 0; c < width; ++c) values[layout.at(f.rows, row, c)] = from[c];
  };
  const auto write_row = [&](const Front& f, int row, const double* values) {
    double* to = &x(pattern_.order[f.first + row], 0);
    for (int c = 0; c < width; ++c) to[c] = values[layout.at(f.rows, row, c)];
  };
  struct Scratch {
    std::vector<int> rows;
    std::vector<double> values;
  };
  tbb::enumerable_thread_specific<Scratch> scratches;
  // Per supernode, in its own front: the amounts that its columns subtract from the rows below; null if none.
  std::vector<std::unique_ptr<double[]>> fronts(parent_.size());
  const auto has_sides = [&](const Front& f) {
    const auto is_zero = [](double value) { return value == 0; };
    for (int r = 0; r < f.columns; ++r)
      if (const double* from = &x(pattern_.order[f.first + r], 0); !std::all_of(from, from + width, is_zero))
        return true;
    return false;
  };
  forest_.visit_up(
      [&](int node) {
        const Front f = front(node);
        const auto has_updates = [&](int child) { return fronts[child] != nullptr; };
        if (std::none_of(children_[node].begin(), children_[node].end(), has_updates) && !has_sides(f)) return;
        fronts[node].reset(new double[layout.size(f.rows)]());
        double* values = fronts[node].get();
        for (int r = 0; r < f.columns; ++r) read_row(f.first + r, f, r, values);
        std::vector<int>& rows = scratches.local().rows;
        for (const int child : children_[node]) {
          if (!has_updates(child)) continue;
          const Front g = front(child);
          rows.resize(g.below());
          for (int r = 0, k = 0; r < g.below(); ++r) {
            while (f.positions[k] < g.positions[g.columns + r]) ++k;
            rows[r] = k;
          }
          const double* updates = fronts[child].get();
          for (int r = 0; r < g.below(); ++r)
            for (int c = 0; c < width; ++c)
              values[layout.at(f.rows, rows[r], c)] += updates[layout.at(g.rows, g.columns + r, c)];
          fronts[child].reset();
        }
        layout.solve(panels + panel_begin_[node], f.rows, f.columns, values);
        for (int r = 0; r < f.columns; ++r) write_row(f, r, values);
      },
      context);
  forest_.visit_down(
      [&](int node) {
        const Front f = front(node);
        std::vector<double>& values = scratches.local().values;
        values.resize(layout.size(f.rows));
        for (int r = 0; r < f.rows; ++r) read_row(f.positions[r], f, r, values.data());
        layout.solve_transposed(panels + panel_begin_[node], f.rows, f.columns, values.data());
        for (int r = 0; r < f.columns; ++r) write_row(f, r, values.data());
      },
      context);
}

}  // namespace meshgraft
