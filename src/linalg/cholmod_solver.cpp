#include <cholmod.h>

#include <mutex>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "backends.h"
#include "blas_threads.h"
#include "dissection.h"
#include "one_thread.h"

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
  ~CholmodSolver() override {
    cholmod_l_free_dense(&work_y_, &common_);
    cholmod_l_free_dense(&work_e_, &common_);
    cholmod_l_free_factor(&factor_, &common_);
    cholmod_l_finish(&common_);
  }

  void analyse(const NormalMatrix& lower, const CouplingGraph& graph, const Context& context) override {
    context.step("analyse");
    // Where each ordering pays (docs/performance.md). METIS dissects the matrix's own graph.
    constexpr Eigen::Index fewest_to_dissect = 8'000, fewest_for_metis = 50'000;
    const bool dissects = graph.neighbours != nullptr && lower.rows() >= fewest_to_dissect;
    const bool use_metis = !dissects && lower.rows() >= fewest_for_metis;
    common_.nmethods = 1;
    common_.method[0].ordering = dissects ? CHOLMOD_GIVEN : use_metis ? CHOLMOD_METIS : CHOLMOD_AMD;
    common_.postorder = 1;
    cholmod_sparse matrix = view(lower);
    std::vector<std::int64_t> order;
    if (dissects) order = dissection_order(matrix, dissect(lower, graph, context));
    cholmod_l_free_factor(&factor_, &common_);
    std::unique_lock metis_lock(metis_mutex(), std::defer_lock);
    if (use_metis) metis_lock.lock();
    factor_ = cholmod_l_analyze_p(&matrix, dissects ? order.data() : nullptr, nullptr, 0, &common_);
    check("analysis");
    context.throw_if_stopped();
    statistics_.backend = "cholmod";
    statistics_.ordering = dissects ? "dissection" : use_metis ? "metis" : "amd";
    statistics_.unknowns = lower.rows();
    statistics_.matrix_nonzeros = lower.nonZeros();
    statistics_.factor_nonzeros = static_cast<std::int64_t>(common_.lnz);
    statistics_.factor_flops = common_.fl;
  }

  void factorise(const NormalMatrix& lower, const Context& context) override {
    context.step("factorise");
    const SingleThreadedBlas single_threaded;
    cholmod_sparse matrix = view(lower);
    with_one_openmp_thread([&] { cholmod_l_factorize(&matrix, factor_, &common_); });
    if (common_.status == CHOLMOD_NOT_POSDEF || factor_->minor < factor_->n)
      throw Error(ErrorCode::unsolvable,
                  fmt::format("the normal equations are not positive definite (at step {} of {})",
                              factor_->minor, factor_->n),
                  "", "Add a constraint, or choose another treatment of degenerate vertices");
    check("factorisation");
    context.throw_if_stopped();
    statistics_.peak_memory_bytes = static_cast<std::int64_t>(common_.memory_usage);
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions&, const Context& context) const override {
    context.throw_if_stopped();
    cholmod_dense b{};
    b.nrow = static_cast<std::size_t>(rhs.rows());
    b.ncol = static_cast<std::size_t>(rhs.cols());
    b.nzmax = b.nrow * b.ncol;
    b.d = b.nrow;
    b.x = const_cast<double*>(rhs.data());
    b.xtype = CHOLMOD_REAL;
    b.dtype = CHOLMOD_DOUBLE;
    const SingleThreadedBlas single_threaded;
    const std::lock_guard lock(mutex_);  // the workspace is shared between callers
    cholmod_dense* x = nullptr;
    with_one_openmp_thread(
        [&] { cholmod_l_solve2(CHOLMOD_A, factor_, &b, nullptr, &x, nullptr, &work_y_, &work_e_, &common_); });
    check("solve");
    Eigen::MatrixXd result =
        Eigen::Map<const Eigen::MatrixXd>(static_cast<const double*>(x->x), rhs.rows(), rhs.cols());
    cholmod_l_free_dense(&x, &common_);
    return result;
  }

  SolverStatistics statistics() const override { return statistics_; }

 private:
  /// Minimum degree within each set of a dissection, set after set.
  std::vector<std::int64_t> dissection_order(cholmod_sparse& matrix, std::vector<std::int64_t> sets) {
    std::vector<std::int64_t> order(sets.size());
    cholmod_l_camd(&matrix, nullptr, 0, sets.data(), order.data(), &common_);
    check("ordering");
    return order;
  }

  void check(const char* stage) const {
    if (common_.status == CHOLMOD_OK) return;
    if (common_.status == CHOLMOD_OUT_OF_MEMORY)
      throw Error(ErrorCode::memory, fmt::format("not enough memory for the {}", stage), "",
                  "Choose a smaller region");
    throw Error(ErrorCode::internal,
                fmt::format("CHOLMOD failed in the {} (status {})", stage, common_.status));
  }

  mutable std::mutex mutex_;
  mutable cholmod_common common_{};
  mutable cholmod_dense* work_y_ = nullptr;
  mutable cholmod_dense* work_e_ = nullptr;
  cholmod_factor* factor_ = nullptr;
  SolverStatistics statistics_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_cholmod_solver() { return std::make_unique<CholmodSolver>(); }

}  // namespace meshgraft
