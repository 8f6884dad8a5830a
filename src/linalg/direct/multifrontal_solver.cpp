#include <algorithm>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>

#include "dissection.h"
#include "graph_partition.h"
#include "linalg/backends.h"
#include "multifrontal.h"
#include "symbolic_factorisation.h"

namespace meshgraft {

namespace {

class MultifrontalSolver final : public LinearSolver {
 public:
  void analyse(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context) override {
    context.step("analyse");
    factor_.emplace(find_pattern(lower, graph, context));
    context.throw_if_stopped();
    statistics_.backend = SolverBackend::multifrontal;
    statistics_.unknowns = lower.rows();
    statistics_.matrix_nonzeros = lower.nonZeros();
    statistics_.factor_nonzeros = static_cast<std::int64_t>(factor_->pattern().factor_nonzeros());
    statistics_.factor_flops = factor_->pattern().flops();
  }

  /// Returns a solver with the same analysis and no factorisation. Returns null for a changed matrix.
  std::unique_ptr<LinearSolver> analysed_copy() const {
    if (factor_ && factor_->has_removed()) return nullptr;
    auto copy = std::make_unique<MultifrontalSolver>();
    if (factor_) copy->factor_.emplace(factor_->pattern());
    copy->statistics_ = statistics_;
    return copy;
  }

  std::unique_ptr<LinearSolver> changed(const MatrixChange& change, const Context& context) const {
    context.step("factorise", 0);
    std::optional<MultifrontalFactor> factor;
    try {
      factor = factor_->changed(change, context);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::unsolvable) throw;
    }
    if (!factor) return nullptr;
    auto copy = std::make_unique<MultifrontalSolver>();
    copy->statistics_ = statistics_;
    copy->statistics_.unknowns -= std::count(change.number.begin(), change.number.end(), -1);
    const NormalMatrix& difference = change.difference;
    for (Eigen::Index column = 0; column < difference.cols(); ++column)
      for (NormalMatrix::InnerIterator it(difference, column); it; ++it)
        if (change.number[column] < 0 || change.number[it.row()] < 0) --copy->statistics_.matrix_nonzeros;
    copy->statistics_.peak_memory_bytes = factor->peak_bytes();
    copy->factor_ = std::move(factor);
    return copy;
  }

  void factorise(const NormalMatrix& lower, const Context& context) override {
    context.step("factorise", 0);
    factorise(factor_->permuted(lower, context), context);
  }

  void factorise_and_free(NormalMatrix& lower, const Context& context) override {
    context.step("factorise", 0);
    LowerEntries entries = factor_->permuted(lower, context);
    NormalMatrix().swap(lower);
    factorise(std::move(entries), context);
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions&,
                        const Context& context) const override {
    return factor_->solve(rhs, context);
  }

  void solve_in_place(Rows& x, const SolveOptions&, const Context& context) const override {
    factor_->solve_in_place(x, context);
  }

  void round_factor() { factor_->round(); }

  SolverStatistics statistics() const override { return statistics_; }

 private:
  void factorise(LowerEntries entries, const Context& context) {
    factor_->factorise(std::move(entries), context);
    statistics_.peak_memory_bytes = factor_->peak_bytes();
  }

  /// Chooses the ordering that is fastest for the size of the matrix (docs/performance.md).
  SupernodalPattern find_pattern(const NormalMatrix& lower, const OrderingGraph& graph,
                                 const Context& context) {
    constexpr Eigen::Index fewest_for_metis = 50'000;
    if (is_worth_dissecting(graph)) {
      statistics_.ordering = Ordering::mesh_dissection;
      return symbolic_factorisation(lower, dissect(lower, graph, context), context);
    }
    if (lower.rows() >= fewest_for_metis) {
      statistics_.ordering = Ordering::nested_dissection;
      return symbolic_factorisation(lower, nested_dissection_order(lower, context), context);
    }
    statistics_.ordering = Ordering::minimum_degree;
    return symbolic_factorisation(lower, one_leaf(lower.rows()), context);
  }

  std::optional<MultifrontalFactor> factor_;
  SolverStatistics statistics_;
};

}  // namespace

std::unique_ptr<LinearSolver> copy_multifrontal_analysis(const LinearSolver& solver) {
  const auto* const multifrontal = dynamic_cast<const MultifrontalSolver*>(&solver);
  return multifrontal == nullptr ? nullptr : multifrontal->analysed_copy();
}

std::unique_ptr<LinearSolver> change_multifrontal_factor(const LinearSolver& solver, const MatrixChange& change,
                                                         const Context& context) {
  const auto* const multifrontal = dynamic_cast<const MultifrontalSolver*>(&solver);
  return multifrontal == nullptr ? nullptr : multifrontal->changed(change, context);
}

void round_multifrontal_factor(LinearSolver& solver) {
  if (auto* const multifrontal = dynamic_cast<MultifrontalSolver*>(&solver)) multifrontal->round_factor();
}

std::unique_ptr<LinearSolver> make_multifrontal_solver() { return std::make_unique<MultifrontalSolver>(); }

}  // namespace meshgraft
