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

  int below() const { return rows - columns; }
  std::int64_t panel_size() const { return static_cast<std::int64_t>(rows) * columns; }
  std::int64_t update_size() const { return static_cast<std::int64_t>(below()) * below(); }
};

MultifrontalFactor::Front MultifrontalFactor::front(int node) const {
  const SupernodalPattern& pattern = shape_->pattern;
  const int first = pattern.first_position[node];
  return {first, pattern.first_position[node + 1] - first,
          static_cast<int>(pattern.rows_begin[node + 1] - pattern.rows_begin[node]),
          pattern.rows.data() + pattern.rows_begin[node]};
}

/// Returns a supernode's columns of L (rows×columns, column-major).
const double* MultifrontalFactor::panel(int node) const {
  if (!replaced_.empty() && replaced_[node] != nullptr) return replaced_[node].get();
  return static_cast<const double*>(panels_->begin) + shape_->panel_begin[node];
}

MultifrontalFactor::Shape::Shape(SupernodalPattern of_matrix)
    : pattern(std::move(of_matrix)),
      parent(parents(pattern)),
      panel_begin(1, 0),
      children(parent.size()),
      forest(parent, work(pattern)) {
  for (int node = 0; node < pattern.supernodes(); ++node) {
    const std::int64_t rows = pattern.rows_begin[node + 1] - pattern.rows_begin[node];
    panel_begin.push_back(panel_begin.back() +
                          rows * (pattern.first_position[node + 1] - pattern.first_position[node]));
    if (parent[node] >= 0) children[parent[node]].push_back(node);
  }
}

MultifrontalFactor::MultifrontalFactor(SupernodalPattern pattern)
    : shape_(std::make_shared<const Shape>(std::move(pattern))) {
  number_unknowns(shape_->pattern.order);
}

void MultifrontalFactor::number_unknowns(std::vector<int> order) {
  order_ = std::move(order);
  inverse_permutation_.resize(order_.size());
  for (std::size_t p = 0; p < order_.size(); ++p) inverse_permutation_[order_[p]] = static_cast<int>(p);
}

/// The data of one factorisation.
struct MultifrontalFactor::Elimination {
  LowerEntries entries;
  UpdateStore store;
  std::vector<UpdateStore::Block> updates;  ///< per supernode, until its parent has added it

  Elimination(LowerEntries of_matrix, int supernodes) : entries(std::move(of_matrix)), updates(supernodes) {}
  double* make_update(int node, const Front& f) {
    if (f.below() > 0) updates[node] = store.take(f.update_size());
    return updates[node].values.get();
  }
};

/// Adds the columns of the children's updates that fall into columns [from, to) of the front to `target`.
/// `target` holds the front's rows and columns from `shift` on, with `stride` rows per column.
void MultifrontalFactor::add_updates(int node, int from, int to, const std::vector<int>& row_at,
                                     const Elimination& elimination, double* target, int shift,
                                     int stride) const {
  std::vector<int> rows;
  for (const int child : shape_->children[node]) {
    const double* update = elimination.updates[child].values.get();
    if (update == nullptr) continue;  // a child that is not eliminated again
    const Front g = front(child);
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

/// Adds the entries of the matrix and the children's updates to the columns of a supernode, and factorises
/// them. `row_at` gives the front's row of a position.
void MultifrontalFactor::complete_panel(int node, double* panel, const std::vector<int>& row_at,
                                        const Elimination& elimination, const Context& context) const {
  const Front f = front(node);
  const LowerEntries& entries = elimination.entries;
  for (int c = 0; c < f.columns; ++c)
    for (std::int64_t e = entries.begin[f.first + c]; e < entries.begin[f.first + c + 1]; ++e)
      panel[row_at[entries.row[e]] + static_cast<std::int64_t>(c) * f.rows] += entries.value[e];
  add_updates(node, 0, f.columns, row_at, elimination, panel, 0, f.rows);
  const int good = factorise_panel(panel, f.rows, f.columns, context);
  if (good < f.columns)
    throw Error(
        facts::linalg::NotPositiveDefinite{.count = order_.size(), .at = std::array{order_[f.first + good]}});
}

/// Adds the children's updates to a front's own one.
void MultifrontalFactor::pass_on_updates(int node, const std::vector<int>& row_at,
                                         Elimination& elimination) const {
  if (const Front f = front(node); f.below() > 0)
    add_updates(node, f.columns, f.rows, row_at, elimination, elimination.updates[node].values.get(), f.columns,
                f.below());
  for (const int child : shape_->children[node])
    elimination.store.give_back(std::move(elimination.updates[child]));
}

/// Eliminates a supernode. The children's updates in the panel are added before its factorisation, the others
/// after the front's own update is formed.
void MultifrontalFactor::eliminate(int node, double* panel, const std::vector<int>& row_at,
                                   Elimination& elimination, const Context& context) const {
  const Front f = front(node);
  std::fill_n(panel, f.panel_size(), 0.0);
  complete_panel(node, panel, row_at, elimination, context);
  form_update(panel, f.rows, f.columns, elimination.make_update(node, f), context);
  pass_on_updates(node, row_at, elimination);
}

/// Eliminates a supernode of a changed matrix. Its front is restored from the panel before. What it passes on
/// is the change of its update.
void MultifrontalFactor::eliminate_again(int node, double* panel, const std::vector<int>& row_at,
                                         Elimination& elimination, const Context& context) const {
  const Front f = front(node);
  const double* const before = this->panel(node);
  restore_panel(before, f.rows, f.columns, panel, context);
  complete_panel(node, panel, row_at, elimination, context);
  double* const update = elimination.make_update(node, f);
  form_update(panel, f.rows, f.columns, update, context);
  take_back_update(before, f.rows, f.columns, update, context);
  pass_on_updates(node, row_at, elimination);
}

/// Calls `visit(node, row_at)` for the chosen supernodes, children before their parents. `row_at` gives the
/// front's row of a position.
void MultifrontalFactor::visit_fronts(const Flags& chosen,
                                      const std::function<void(int, const std::vector<int>&)>& visit,
                                      const Context& context) const {
  const SingleThreadedBlas single_threaded(context);
  std::int64_t columns = 0;
  for (int node = 0; node < supernodes(); ++node) columns += chosen[node] ? front(node).columns : 0;
  std::atomic<std::int64_t> eliminated = 0;
  tbb::enumerable_thread_specific<std::vector<int>> row_maps([&] { return std::vector<int>(order_.size()); });
  const auto caller = std::this_thread::get_id();
  shape_->forest.visit_up(
      [&](int node) {
        if (!chosen[node]) return;
        const Front f = front(node);
        std::vector<int>& row_at = row_maps.local();
        for (int r = 0; r < f.rows; ++r) row_at[f.positions[r]] = r;
        visit(node, row_at);
        eliminated += f.columns;
        if (std::this_thread::get_id() == caller)
          context.step("factorise", static_cast<double>(eliminated) / static_cast<double>(columns));
      },
      context);
}

LowerEntries MultifrontalFactor::permuted(const NormalMatrix& lower, const Context& context) const {
  return permute(lower, inverse_permutation_, true, context);
}

void MultifrontalFactor::factorise(LowerEntries entries, const Context& context) {
  Elimination elimination(std::move(entries), supernodes());
  rounded_.reset();
  replaced_.clear();
  panels_.reset();  // frees it before the allocation
  panels_ = std::make_shared<Memory>(allocate_doubles(panel_numbers()));
  auto* const panels = static_cast<double*>(panels_->begin);
  visit_fronts(
      Flags(supernodes(), 1),
      [&](int node, const std::vector<int>& row_at) {
        eliminate(node, panels + shape_->panel_begin[node], row_at, elimination, context);
      },
      context);
  count_peak(panel_numbers() + elimination.store.peak());
}

void MultifrontalFactor::count_peak(std::int64_t numbers) {
  peak_bytes_ = static_cast<std::int64_t>(sizeof(double)) * numbers +
                static_cast<std::int64_t>(sizeof(int)) * static_cast<std::int64_t>(shape_->pattern.rows.size());
}

/// Returns the supernodes with an entry in their columns, and all ancestors of these.
Flags MultifrontalFactor::supernodes_above(const LowerEntries& entries) const {
  const SupernodalPattern& pattern = shape_->pattern;
  Flags above(supernodes(), 0);
  for (int node = 0; node < supernodes(); ++node) {
    above[node] |=
        entries.begin[pattern.first_position[node]] < entries.begin[pattern.first_position[node + 1]];
    if (const int parent = shape_->parent[node]; parent >= 0) above[parent] |= above[node];
  }
  return above;
}

std::optional<MultifrontalFactor> MultifrontalFactor::changed(const MatrixChange& change,
                                                              const Context& context) const {
  // Eliminating a supernode again takes twice the work. Removed unknowns still take part in every solve.
  constexpr double largest_share = 0.45, most_removed = 0.25;
  const auto kept = static_cast<double>(change.number.size()) -
                    static_cast<double>(std::count(change.number.begin(), change.number.end(), -1));
  if (kept < (1 - most_removed) * static_cast<double>(order_.size())) return std::nullopt;
  Elimination elimination(permuted(change.difference, context), supernodes());
  const Flags again = supernodes_above(elimination.entries);
  double of_changed = 0, of_all = 0;
  const std::vector<double> operations = work(shape_->pattern);
  for (int node = 0; node < supernodes(); ++node) {
    of_all += operations[node];
    if (again[node]) of_changed += operations[node];
  }
  if (of_changed > largest_share * of_all) return std::nullopt;

  MultifrontalFactor result(*this);
  result.renumber(change.number);
  result.replaced_.resize(supernodes());
  std::atomic<std::int64_t> numbers = 0;
  visit_fronts(
      again,
      [&](int node, const std::vector<int>& row_at) {
        const std::int64_t size = front(node).panel_size();
        std::shared_ptr<double[]> panel(new double[size]);
        eliminate_again(node, panel.get(), row_at, elimination, context);
        result.replaced_[node] = std::move(panel);
        numbers += size;
      },
      context);
  result.count_peak(numbers + elimination.store.peak());
  return result;
}

/// Numbers the unknowns anew. Removed ones get the numbers after the last.
void MultifrontalFactor::renumber(const std::vector<int>& number) {
  auto removed = static_cast<int>(number.size() - std::count(number.begin(), number.end(), -1));
  std::vector<int> order = order_;
  for (int& unknown : order) {
    const bool stays = unknown < static_cast<int>(number.size()) && number[unknown] >= 0;
    unknown = stays ? number[unknown] : removed++;
  }
  number_unknowns(std::move(order));
  has_removed_ = true;
}

/// Returns whether the factor has no number beyond the range of single precision, and no diagonal below it.
bool MultifrontalFactor::is_within_singles() const {
  constexpr double least = 1e-30, most = 1e30;
  for (int node = 0; node < supernodes(); ++node) {
    const Front f = front(node);
    for (int c = 0; c < f.columns; ++c)
      if (!(panel(node)[static_cast<std::int64_t>(c) * (f.rows + 1)] > least)) return false;
  }
  const auto* const values = static_cast<const double*>(panels_->begin);
  return std::all_of(values, values + panel_numbers(), [](double value) { return std::abs(value) < most; });
}

// Rounds in place, because the first access to other memory would take longer.
void MultifrontalFactor::round() {
  const std::int64_t count = panel_numbers();
  if (count == 0 || panels_.use_count() > 1 || !replaced_.empty() || !is_within_singles()) return;
  void* const memory = std::exchange(panels_->begin, nullptr);
  panels_.reset();
  for (std::int64_t k = 0; k < count; ++k) {
    double value = 0;
    std::memcpy(&value, static_cast<const double*>(memory) + k, sizeof value);
    const auto rounded = static_cast<float>(value);
    std::memcpy(static_cast<float*>(memory) + k, &rounded, sizeof rounded);
  }
  void* const shrunk = std::realloc(memory, static_cast<std::size_t>(count) * sizeof(float));
  rounded_ = std::make_shared<Memory>(shrunk != nullptr ? shrunk : memory);
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
  const auto panel_of = [&](int node) { return panel(node); };
  for (Eigen::Index begin = 0; begin < x.cols(); begin += wide_columns) {
    const auto width = static_cast<int>(std::min<Eigen::Index>(wide_columns, x.cols() - begin));
    if (rounded_)
      substitute(
          x.middleCols(begin, width), NarrowLayout{width},
          [&](int node) { return static_cast<const float*>(rounded_->begin) + shape_->panel_begin[node]; },
          context);
    else if (width <= few)
      substitute(x.middleCols(begin, width), NarrowLayout{width}, panel_of, context);
    else
      substitute(x.middleCols(begin, width), WideLayout{width}, panel_of, context);
  }
}

/// Computes x ← P L⁻ᵀ L⁻¹ Pᵀ x. A front reads all right-hand sides of an unknown at once, because x is stored
/// row by row. The way up leaves out subtrees where all right-hand sides are zero.
template <class Layout, class PanelOf>
void MultifrontalFactor::substitute(Eigen::Ref<LinearSolver::Rows> x, const Layout& layout,
                                    const PanelOf& panel_of, const Context& context) const {
  const int width = layout.width;
  const std::array<double, wide_columns> zeros{};  // the values of removed unknowns
  const auto is_removed = [&](int position) { return order_[position] >= x.rows(); };
  const auto read_row = [&](int position, const Front& f, int row, double* values) {
    const double* from = is_removed(position) ? zeros.data() : &x(order_[position], 0);
    for (int c = 0; c < width; ++c) values[layout.at(f.rows, row, c)] = from[c];
  };
  const auto write_row = [&](const Front& f, int row, const double* values) {
    if (is_removed(f.first + row)) return;
    double* to = &x(order_[f.first + row], 0);
    for (int c = 0; c < width; ++c) to[c] = values[layout.at(f.rows, row, c)];
  };
  struct Scratch {
    std::vector<int> rows;
    std::vector<double> values;
  };
  tbb::enumerable_thread_specific<Scratch> scratches;
  // Per supernode, in its own front: the amounts that its columns subtract from the rows below; null if none.
  std::vector<std::unique_ptr<double[]>> fronts(supernodes());
  const auto has_sides = [&](const Front& f) {
    const auto is_zero = [](double value) { return value == 0; };
    for (int r = 0; r < f.columns; ++r)
      if (!is_removed(f.first + r))
        if (const double* from = &x(order_[f.first + r], 0); !std::all_of(from, from + width, is_zero))
          return true;
    return false;
  };
  shape_->forest.visit_up(
      [&](int node) {
        const Front f = front(node);
        const std::vector<int>& children = shape_->children[node];
        const auto has_updates = [&](int child) { return fronts[child] != nullptr; };
        if (std::none_of(children.begin(), children.end(), has_updates) && !has_sides(f)) return;
        fronts[node].reset(new double[layout.size(f.rows)]());
        double* values = fronts[node].get();
        for (int r = 0; r < f.columns; ++r) read_row(f.first + r, f, r, values);
        std::vector<int>& rows = scratches.local().rows;
        for (const int child : children) {
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
        layout.solve(panel_of(node), f.rows, f.columns, values);
        for (int r = 0; r < f.columns; ++r) write_row(f, r, values);
      },
      context);
  shape_->forest.visit_down(
      [&](int node) {
        const Front f = front(node);
        std::vector<double>& values = scratches.local().values;
        values.resize(layout.size(f.rows));
        for (int r = 0; r < f.rows; ++r) read_row(f.positions[r], f, r, values.data());
        layout.solve_transposed(panel_of(node), f.rows, f.columns, values.data());
        for (int r = 0; r < f.columns; ++r) write_row(f, r, values.data());
      },
      context);
}

}  // namespace meshgraft
