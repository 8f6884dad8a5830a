#include <meshgraft/linalg/linear_solver.h>

#include <cmath>

#include <meshgraft/core/error.h>

#include "backends.h"
#include "early_bisection.h"
#include "linalg/facts.h"

namespace meshgraft {

std::vector<SolverBackend> available_backends() {
#ifdef MESHGRAFT_HAS_MULTIFRONTAL
  return {SolverBackend::multifrontal, SolverBackend::eigen, SolverBackend::iterative};
#else
  return {SolverBackend::eigen, SolverBackend::iterative};
#endif
}

std::string_view name_of(SolverBackend backend) {
  switch (backend) {
    case SolverBackend::automatic: return "auto";
    case SolverBackend::multifrontal: return "multifrontal";
    case SolverBackend::eigen: return "eigen";
    case SolverBackend::iterative: return "iterative";
  }
  return {};
}

std::string_view name_of(Ordering ordering) {
  switch (ordering) {
    case Ordering::minimum_degree: return "amd";
    case Ordering::nested_dissection: return "metis";
    case Ordering::mesh_dissection: return "dissection";
  }
  return {};
}

std::unique_ptr<LinearSolver> make_solver(SolverBackend backend) {
  if (backend == SolverBackend::automatic) backend = available_backends().front();
  if (backend == SolverBackend::eigen) return make_eigen_solver();
  if (backend == SolverBackend::iterative) return make_iterative_solver();
#ifdef MESHGRAFT_HAS_MULTIFRONTAL
  return make_multifrontal_solver();
#else
  throw Error(facts::linalg::NoMultifrontalSolver{}, "backend");
#endif
}

std::unique_ptr<LinearSolver> copy_analysis([[maybe_unused]] const LinearSolver& solver) {
#ifdef MESHGRAFT_HAS_MULTIFRONTAL
  return copy_multifrontal_analysis(solver);
#else
  return nullptr;
#endif
}

std::unique_ptr<LinearSolver> change_factor([[maybe_unused]] const LinearSolver& solver,
                                            [[maybe_unused]] const MatrixChange& change,
                                            [[maybe_unused]] const Context& context) {
#ifdef MESHGRAFT_HAS_MULTIFRONTAL
  return change_multifrontal_factor(solver, change, context);
#else
  return nullptr;
#endif
}

void round_factor([[maybe_unused]] LinearSolver& solver) {
#ifdef MESHGRAFT_HAS_MULTIFRONTAL
  round_multifrontal_factor(solver);
#endif
}

std::future<void> begin_bisection([[maybe_unused]] const OrderingGraph& graph,
                                  [[maybe_unused]] SolverBackend backend,
                                  [[maybe_unused]] const Context& context) {
#ifdef MESHGRAFT_HAS_MULTIFRONTAL
  const bool is_multifrontal = backend == SolverBackend::automatic || backend == SolverBackend::multifrontal;
  if (is_multifrontal && context.threads != 1)
    return std::async(
        [&graph, stop = context.stop_token] { bisect_for_multifrontal(graph, {.stop_token = stop}); });
#endif
  return std::async(std::launch::deferred, [] {});
}

double one_norm(const NormalMatrix& lower) {
  Eigen::VectorXd column_sums = Eigen::VectorXd::Zero(lower.cols());
  for (Eigen::Index column = 0; column < lower.cols(); ++column) {
    for (NormalMatrix::InnerIterator it(lower, column); it; ++it) {
      column_sums[column] += std::abs(it.value());
      if (it.row() != column) column_sums[it.row()] += std::abs(it.value());
    }
  }
  return column_sums.size() > 0 ? column_sums.maxCoeff() : 0;
}

double estimate_condition(double norm, const LinearSolver& solver, const Context& context) {
  const Eigen::Index n = solver.statistics().unknowns;
  if (n == 0) return 1;
  // Hager's ascent for ‖N⁻¹‖₁. N is symmetric, so the same solve serves both of its steps.
  Eigen::VectorXd x = Eigen::VectorXd::Constant(n, 1.0 / static_cast<double>(n));
  double inverse_norm = 0;
  constexpr int most_steps = 5;
  for (int step = 0; step < most_steps; ++step) {
    const Eigen::VectorXd y = solver.solve(x, context);
    const double growth = y.lpNorm<1>();
    if (growth <= inverse_norm) break;
    inverse_norm = growth;
    const Eigen::VectorXd sign = y.unaryExpr([](double value) { return value < 0 ? -1.0 : 1.0; });
    const Eigen::VectorXd gradient = solver.solve(sign, context);
    Eigen::Index steepest = 0;
    gradient.cwiseAbs().maxCoeff(&steepest);
    if (std::abs(gradient[steepest]) <= gradient.dot(x)) break;
    x.setZero();
    x[steepest] = 1;
  }
  return norm * inverse_norm;
}

}  // namespace meshgraft
