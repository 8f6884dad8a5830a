#pragma once

#include <cstdint>
#include <cstdlib>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "core/parallel.h"
#include "linalg/matrix_change.h"
#include "symbolic_factorisation.h"

namespace meshgraft {

/// The Cholesky factor P N Pᵀ = L Lᵀ by the multifrontal method (Duff & Reid 1983; Liu 1992). The
/// factorisation goes up the elimination tree. Each supernode gathers its columns of N and its children's
/// updates in a dense front. It eliminates its own columns and passes the remaining update to its parent.
/// Subtrees run in parallel, and so do the tiles of large fronts. Sums have a fixed order, so the result does
/// not depend on the number of threads.
class MultifrontalFactor {
 public:
  explicit MultifrontalFactor(SupernodalPattern pattern);

  /// Returns the factor of a changed N, or nullopt if little work would be saved. Supernodes with a changed
  /// column and their ancestors get new panels; all others are shared. At each of those, the front as it was is
  /// computed from its panel, so that no update has to be kept. Throws Error(unsolvable) if the changed N is
  /// not positive definite.
  std::optional<MultifrontalFactor> changed(const MatrixChange& change, const Context& context) const;

  /// Returns the entries of N by position, as `factorise` reads them.
  LowerEntries permuted(const NormalMatrix& lower, const Context& context) const;
  /// Throws Error(unsolvable) if N is not positive definite.
  void factorise(LowerEntries entries, const Context& context);

  /// Rounds the factor to single precision, in half the memory, unless its numbers leave that range.
  /// Substitution is still in double precision.
  void round();

  /// Returns N⁻¹ times all columns of `rhs`. Safe to call from several threads at once.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const Context& context) const;
  /// Replaces right-hand sides by their solutions.
  void solve_in_place(LinearSolver::Rows& x, const Context& context) const;

  const SupernodalPattern& pattern() const { return shape_->pattern; }
  bool has_removed() const { return has_removed_; }        ///< whether unknowns were removed by `changed`
  std::int64_t peak_bytes() const { return peak_bytes_; }  ///< values and updates of the last factorisation

 private:
  struct Front;
  struct Elimination;
  /// The rows of all supernodes and their tree. It is the same for a changed matrix.
  struct Shape {
    explicit Shape(SupernodalPattern of_matrix);

    SupernodalPattern pattern;
    std::vector<int> parent;                ///< per supernode, -1 at roots
    std::vector<std::int64_t> panel_begin;  ///< per supernode: its first index among all panels' numbers
    std::vector<std::vector<int>> children;
    TaskForest forest;
  };
  struct Memory {
    void* begin;
    explicit Memory(void* allocated) : begin(allocated) {}
    Memory(const Memory&) = delete;
    Memory& operator=(const Memory&) = delete;
    ~Memory() { std::free(begin); }
  };

  int supernodes() const { return shape_->pattern.supernodes(); }
  std::int64_t panel_numbers() const { return shape_->panel_begin.back(); }
  const double* panel(int node) const;
  Front front(int node) const;
  bool is_within_singles() const;
  void number_unknowns(std::vector<int> order);
  void renumber(const std::vector<int>& number);
  void count_peak(std::int64_t numbers);
  Flags supernodes_above(const LowerEntries& entries) const;
  void visit_fronts(const Flags& chosen, const std::function<void(int, const std::vector<int>&)>& visit,
                    const Context& context) const;
  void add_updates(int node, int from, int to, const std::vector<int>& row_at, const Elimination& elimination,
                   double* target, int shift, int stride) const;
  void complete_panel(int node, double* panel, const std::vector<int>& row_at, const Elimination& elimination,
                      const Context& context) const;
  void pass_on_updates(int node, const std::vector<int>& row_at, Elimination& elimination) const;
  void eliminate(int node, double* panel, const std::vector<int>& row_at, Elimination& elimination,
                 const Context& context) const;
  void eliminate_again(int node, double* panel, const std::vector<int>& row_at, Elimination& elimination,
                       const Context& context) const;
  template <class Layout, class PanelOf>
  void substitute(Eigen::Ref<LinearSolver::Rows> x, const Layout& layout, const PanelOf& panel_of,
                  const Context& context) const;

  std::shared_ptr<const Shape> shape_;
  /// The unknown at each position. Numbers that the matrix does not have stand for removed unknowns.
  std::vector<int> order_;
  std::vector<int> inverse_permutation_;  ///< per unknown: its position
  bool has_removed_ = false;
  std::shared_ptr<Memory> panels_;   ///< doubles; null after `round`
  std::shared_ptr<Memory> rounded_;  ///< floats; null before
  /// Per supernode: the panel to use in place of that in `panels_`, or null. Empty if none is replaced.
  std::vector<std::shared_ptr<const double[]>> replaced_;
  std::int64_t peak_bytes_ = 0;
};

}  // namespace meshgraft
