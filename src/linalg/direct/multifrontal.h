#pragma once

#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>

#include "core/parallel.h"
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

  const SupernodalPattern& pattern() const { return pattern_; }
  std::int64_t peak_bytes() const { return peak_bytes_; }  ///< values and updates of the last factorisation

 private:
  struct Front;
  struct Elimination;
  Front front(int node) const;
  bool is_within_singles() const;
  void gather_panel(const Front& f, const LowerEntries& entries, const std::vector<int>& row_at) const;
  void add_updates(int node, int from, int to, const std::vector<int>& row_at, const Elimination& elimination,
                   double* target, int shift, int stride) const;
  void eliminate(int node, std::vector<int>& row_at, Elimination& elimination, const Context& context) const;
  template <class Layout, class Number>
  void substitute(Eigen::Ref<LinearSolver::Rows> x, const Layout& layout, const Number* panels,
                  const Context& context) const;

  SupernodalPattern pattern_;
  std::vector<int> inverse_permutation_;   ///< per unknown: its position
  std::vector<int> parent_;                ///< per supernode, -1 at roots
  std::vector<std::int64_t> panel_begin_;  ///< per supernode: index in `values_`; one more at the end
  std::vector<std::vector<int>> children_;
  TaskForest forest_;
  struct Free {
    void operator()(void* memory) const { std::free(memory); }
  };
  std::unique_ptr<double[], Free> values_;  ///< null after `round`
  std::unique_ptr<float[], Free> rounded_;  ///< null before
  std::int64_t peak_bytes_ = 0;
};

}  // namespace meshgraft
