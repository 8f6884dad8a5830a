#include <array>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCholesky>

#include <meshgraft/core/error.h>

#include "linalg/backends.h"
#include "linalg/facts.h"

namespace meshgraft {

namespace {

class EigenSolver final : public LinearSolver {
 public:
  void analyse(const NormalMatrix& lower, const OrderingGraph&, const Context& context) override {
    context.step("analyse");
    cholesky_.analyzePattern(lower);
    statistics_.backend = SolverBackend::eigen;
    statistics_.ordering = Ordering::minimum_degree;
    statistics_.unknowns = lower.rows();
    statistics_.matrix_nonzeros = lower.nonZeros();
  }

  void factorise(const NormalMatrix& lower, const Context& context) override {
    context.step("factorise");
    cholesky_.factorize(lower);
    if (cholesky_.info() != Eigen::Success)
      throw Error(facts::linalg::NotPositiveDefinite{.count = lower.rows(), .at = std::array<Index, 0>{}});
    const auto& factor = cholesky_.matrixL().nestedExpression();
    statistics_.factor_nonzeros = factor.nonZeros();
    statistics_.factor_flops = 0;
    for (Eigen::Index column = 0; column < factor.cols(); ++column) {
      const auto length =
          static_cast<double>(factor.outerIndexPtr()[column + 1] - factor.outerIndexPtr()[column]);
      statistics_.factor_flops += length * length;
    }
    constexpr std::int64_t bytes_per_nonzero = sizeof(double) + sizeof(std::int64_t);
    statistics_.peak_memory_bytes = (factor.nonZeros() + lower.nonZeros()) * bytes_per_nonzero;
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions&,
                        const Context& context) const override {
    context.throw_if_stopped();
    return cholesky_.solve(rhs);
  }

  SolverStatistics statistics() const override { return statistics_; }

 private:
  Eigen::SimplicialLLT<NormalMatrix, Eigen::Lower, Eigen::AMDOrdering<std::int64_t>> cholesky_;
  SolverStatistics statistics_;
};

}  // namespace

std::unique_ptr<LinearSolver> make_eigen_solver() { return std::make_unique<EigenSolver>(); }

}  // namespace meshgraft
