#include <cholmod.h>

#include <mutex>
#include <optional>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "backends.h"
#include "dissection.h"
#include "multifrontal.h"

namespace meshgraft {

namespace {

static_assert(sizeof(SuiteSparse_long) == sizeof(std::int64_t));

/// A view of our matrix in CHOLMOD's terms; nothing is copied.
cholmod_sparse view(const NormalMatrix& lower) {
  cholmod_sparse matrix{};
  matrix.nrow = static_cast<std::size_t>(lower.rows());
  matrix.ncol = static_cast<std::size_t>(lower.cols());
  matrix.nzmax = static_cast<std::size_t>(lower.nonZeros());
  matrix.p = const_cast<std::int64_t*>(lower.outerIndexPtr());
  matrix.i = const_cast<std::int64_t*>(lower.innerIndexPtr());
  matrix.x = const_cast<double*>(lower.valuePtr());
  matrix.stype = -1;
  matrix.itype = CHOLMOD_LONG;
  matrix.xtype = CHOLMOD_REAL;
  matrix.dtype = CHOLMOD_DOUBLE;
  matrix.sorted = 1;
  matrix.packed = 1;
  return matrix;
}

class CholmodSolver final : public LinearSolver {
 public:
  CholmodSolver() {
    cholmod_l_start(&common_);
    common_.print = 0;
    common_.error_handler = nullptr;
    common_.supernodal = CHOLMOD_SUPERNODAL;
    common_.final_ll = 1;
  }
  CholmodSolver(const CholmodSolver&) = delete;
  CholmodSolver& operator=(const CholmodSolver&) = delete;
  ~CholmodSolver() override { cholmod_l_finish(&common_); }

  void analyse(const NormalMatrix& lower, const CouplingGraph& graph, const Context& context) override {
    context.step("analyse");
    // Where each ordering pays (docs/performance.md). METIS dissects the matrix's own graph.
    constexpr Eigen::Index fewest_to_dissect = 8'000, fewest_for_metis = 50'000;
    const bool dissects = graph.neighbours != nullptr && lower.rows() >= fewest_to_dissect;
    const bool use_metis = !dissects && lower.rows() >= fewest_for_metis;
    statistics_.ordering = dissects ? "dissection" : use_metis ? "metis" : "amd";
    factor_.emplace(dissects ? find_supernodes(lower, dissect(lower, graph, context), context)
                             : find_supernodes_of(view(lower), use_metis ? CHOLMOD_METIS : CHOLMOD_AMD));
    context.throw_if_stopped();
    statistics_.backend = "cholmod";
    statistics_.unknowns = lower.rows();
    statistics_.matrix_nonzeros = lower.nonZeros();
    statistics_.factor_nonzeros = static_cast<std::int64_t>(factor_->pattern().factor_nonzeros());
    statistics_.factor_flops = factor_->pattern().flops();
  }

  void factorise(const NormalMatrix& lower, const Context& context) override {
    context.step("factorise", 0);
    factor_->factorise(lower, context);
    statistics_.peak_memory_bytes = factor_->peak_bytes();
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions&,
                        const Context& context) const override {
    return factor_->solve(rhs, context);
  }

  SolverStatistics statistics() const override { return statistics_; }

 private:
  /// Of the matrix's own graph, by CHOLMOD's orderings.
  SupernodalPattern find_supernodes_of(cholmod_sparse matrix, int ordering) {
    common_.nmethods = 1;
    common_.method[0].ordering = ordering;
    common_.postorder = 1;
    std::unique_lock metis_lock(metis_mutex(), std::defer_lock);
    if (ordering == CHOLMOD_METIS) metis_lock.lock();
    cholmod_factor* symbolic = cholmod_l_analyze(&matrix, &common_);
    check("analysis");
    SupernodalPattern pattern = pattern_of(*symbolic);
    cholmod_l_free_factor(&symbolic, &common_);
    return pattern;
  }

  void check(const char* stage) const {
    if (common_.status == CHOLMOD_OK) return;
    if (common_.status == CHOLMOD_OUT_OF_MEMORY)
      throw Error(ErrorCode::memory, fmt::format("not enough memory for the {}", stage), "",
                  "Choose a smaller region");
    throw Error(ErrorCode::internal,
                fmt::format("CHOLMOD failed in the {} (status {})", stage, common_.status));
  }

  static SupernodalPattern pattern_of(const cholmod_factor& symbolic) {
    const auto copy = [](const void* from, std::size_t count, auto& to) {
      const auto* first = static_cast<const std::int64_t*>(from);
      to.assign(first, first + count);
    };
    SupernodalPattern pattern;
    copy(symbolic.Perm, symbolic.n, pattern.order);
    copy(symbolic.super, symbolic.nsuper + 1, pattern.first_place);
    copy(symbolic.pi, symbolic.nsuper + 1, pattern.rows_begin);
    copy(symbolic.s, symbolic.ssize, pattern.rows);
    return pattern;
  }

  cholmod_common common_{};
  std::optional<MultifrontalFactor> factor_;
  SolverStatistics statistics_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod_solver() { return std::make_unique<CholmodSolver>(); }

}  // namespace meshgraft
