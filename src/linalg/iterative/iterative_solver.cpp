#include <array>
#include <atomic>
#include <cmath>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>

#include "block_matrix.h"
#include "block_rows.h"
#include "coarse_space.h"
#include "core/parallel.h"
#include "linalg/backends.h"
#include "linalg/facts.h"

namespace meshgraft {

namespace {

constexpr std::size_t rows_at_once = 16384;

/// One number per column.
using FourNumbers = Eigen::Array<double, 1, 4>;

/// Computes Σ x y per column, in parts of fixed size so that rounding does not depend on the threads.
FourNumbers dot(const FourColumns& x, const FourColumns& y, const Context& context) {
  constexpr Eigen::Index part_size = 8192;
  const std::size_t parts = (x.rows() + part_size - 1) / part_size;
  std::vector<FourNumbers> sums(parts);
  parallel_blocks(
      parts,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t part = begin; part < end; ++part) {
          const Eigen::Index first = static_cast<Eigen::Index>(part) * part_size;
          const Eigen::Index rows = std::min(part_size, x.rows() - first);
          FourNumbers sum = FourNumbers::Zero();
          for (Eigen::Index row = first; row < first + rows; ++row)
            sum += x.row(row).array() * y.row(row).array();
          sums[part] = sum;
        }
      },
      context, 4);
  FourNumbers total = FourNumbers::Zero();
  for (const FourNumbers& sum : sums) total += sum;
  return total;
}

/// Computes y ← y_scale y + x_scale x, column by column.
void combine(const FourNumbers& y_scale, FourColumns& y, const FourNumbers& x_scale, const FourColumns& x,
             const Context& context) {
  parallel_blocks(
      y.rows(),
      [&](std::size_t begin, std::size_t end) {
        for (auto row = static_cast<Eigen::Index>(begin); row < static_cast<Eigen::Index>(end); ++row)
          y.row(row) = (y_scale * y.row(row).array() + x_scale * x.row(row).array()).matrix();
      },
      context, rows_at_once);
}

/// Solves by conjugate gradients (Hestenes and Stiefel 1952) on up to four columns at once, each with its own
/// scalars. The preconditioner is a two-grid method: a Gauss-Seidel sweep, the exact solution on the coarse
/// grid, and a backward sweep.
class IterativeSolver final : public LinearSolver {
 public:
  void analyse(const NormalMatrix& lower, const OrderingGraph& graph, const Context& context) override {
    context.step("analyse");
    coarse_space_.reset();
    matrix_.reset();
    order_ = order_nodes(lower, graph, context);
    context.step("analyse", 0.6);
    matrix_ = make_block_matrix(order_);
    context.throw_if_stopped();
    coarse_space_.emplace(order_, context);
    context.throw_if_stopped();
    coarse_neighbours_ = coarse_space_->coarse_neighbours(context);
    context.throw_if_stopped();
    statistics_ = {};
    statistics_.backend = SolverBackend::iterative;
    statistics_.unknowns = lower.rows();
    statistics_.matrix_nonzeros = lower.nonZeros();
    statistics_.coarse_unknowns = coarse_space_->unknowns();
  }

  void factorise(const NormalMatrix& lower, const Context& context) override {
    context.step("factorise");
    matrix_->set_values(lower, context);
    factorise_coarse(context);
  }

  void factorise_and_free(NormalMatrix& lower, const Context& context) override {
    context.step("factorise");
    matrix_->set_values(lower, context);
    NormalMatrix().swap(lower);
    factorise_coarse(context);
  }

  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions& options,
                        const Context& context) const override {
    Rows x = rhs;
    solve_in_place(x, options, context);
    return x;
  }

  void solve_in_place(Rows& x, const SolveOptions& options, const Context& context) const override {
    int iterations = 0;
    for (Eigen::Index first = 0; first < x.cols(); first += 4)
      iterations = std::max(iterations, solve_four(x, first, options, context));
    iterations_ = iterations;
  }

  SolverStatistics statistics() const override {
    SolverStatistics statistics = statistics_;
    statistics.iterations = iterations_;
    return statistics;
  }

 private:
  void factorise_coarse(const Context& context) {
    context.step("factorise", 0.3);
    NormalMatrix coarse = coarse_space_->restrict_matrix(*matrix_, context);
    context.step("factorise", 0.6);
    coarse_solver_ = make_solver(available_backends().front());
    coarse_solver_->analyse(coarse, coarse_space_->ordering_graph(coarse_neighbours_),
                            {.threads = context.threads, .stop_token = context.stop_token});
    const auto coarse_nonzeros = static_cast<double>(coarse.nonZeros());
    coarse_solver_->factorise_and_free(coarse, {.threads = context.threads, .stop_token = context.stop_token});
    round_factor(*coarse_solver_);
    matrix_->prepare_sweeps(context);
    context.step("factorise", 1.0);

    const SolverStatistics of_coarse = coarse_solver_->statistics();
    statistics_.ordering = of_coarse.ordering;
    statistics_.factor_nonzeros = of_coarse.factor_nonzeros;
    statistics_.factor_flops = of_coarse.factor_flops;
    statistics_.operator_complexity =
        1 + coarse_nonzeros / static_cast<double>(std::max<std::int64_t>(1, statistics_.matrix_nonzeros));
    statistics_.peak_memory_bytes = matrix_->bytes() + coarse_space_->bytes() + of_coarse.peak_memory_bytes;
  }

  /// Returns up to four columns of values per unknown, by rows of the block matrix.
  template <class Values>
  FourColumns to_rows(const Values& values, Eigen::Index first, const Context& context) const {
    const std::vector<int>& unknown = order_.nodes.unknown;
    const Eigen::Index columns = std::min<Eigen::Index>(4, values.cols() - first);
    FourColumns rows = FourColumns::Zero(static_cast<Eigen::Index>(unknown.size()), 4);
    parallel_blocks(
        unknown.size(),
        [&](std::size_t begin, std::size_t end) {
          for (auto row = static_cast<Eigen::Index>(begin); row < static_cast<Eigen::Index>(end); ++row)
            if (unknown[row] >= 0)
              for (Eigen::Index c = 0; c < columns; ++c) rows(row, c) = values(unknown[row], first + c);
        },
        context, rows_at_once);
    return rows;
  }

  /// Computes z = M⁻¹ r. The preconditioner M is symmetric and positive definite. `s` and `e` are scratch data.
  void precondition(const FourColumns& r, Eigen::Index columns, FourColumns& z, FourColumns& s, FourColumns& e,
                    const Context& context) const {
    matrix_->sweep_forward(r, z, s, context);
    const Eigen::MatrixXd coarse = coarse_space_->restrict_columns(s, columns, context);
    coarse_space_->prolong(coarse_solver_->solve(coarse, context), e, context);
    matrix_->sweep_backward(e, s, z, context);
  }

  /// Replaces up to four right-hand sides from column `first` on by their solutions. Returns the number of
  /// iterations.
  int solve_four(Rows& sides, Eigen::Index first, const SolveOptions& options, const Context& context) const {
    constexpr int most_iterations = 1000;
    const auto quotient = [](const FourNumbers& a, const FourNumbers& b) {
      return FourNumbers((b > 0).select(a / b, 0.0));
    };
    const Context quiet{.threads = context.threads, .progress = {}, .stop_token = context.stop_token};
    const Eigen::Index columns = std::min<Eigen::Index>(4, sides.cols() - first);
    // q = N p is not needed beyond the update of r, and is scratch data of the preconditioner then.
    FourColumns r = to_rows(sides, first, quiet), x = FourColumns::Zero(r.rows(), 4), z, p, q, e;
    precondition(r, columns, z, q, e, quiet);
    FourNumbers rz = dot(r, z, quiet);
    const FourNumbers goal = options.tolerance * options.tolerance * rz;
    if (options.guess != nullptr) {
      x = to_rows(*options.guess, first, quiet);
      matrix_->multiply(x, q, quiet);
      combine(FourNumbers::Ones(), r, -FourNumbers::Ones(), q, quiet);
      precondition(r, columns, z, q, e, quiet);
      rz = dot(r, z, quiet);
    }
    const double start = quotient(rz, goal).maxCoeff();
    p = z;
    int iteration = 0;
    for (; (rz > goal).any(); ++iteration) {
      context.step("solve", std::log(start / quotient(rz, goal).maxCoeff()) / std::log(start));
      matrix_->multiply(p, q, quiet);
      const FourNumbers pq = dot(p, q, quiet);
      if (iteration == most_iterations || !rz.isFinite().all() || !pq.isFinite().all() || (pq < 0).any())
        throw Error(facts::linalg::NotConverged{
            .iterations = iteration,
            .error = options.tolerance * std::sqrt(std::max(0.0, quotient(rz, goal).maxCoeff())),
            .tolerance = options.tolerance});
      const FourNumbers alpha = quotient(rz, pq);
      combine(FourNumbers::Ones(), x, alpha, p, quiet);
      combine(FourNumbers::Ones(), r, -alpha, q, quiet);
      precondition(r, columns, z, q, e, quiet);
      const FourNumbers rz_before = std::exchange(rz, dot(r, z, quiet));
      combine(quotient(rz, rz_before), p, FourNumbers::Ones(), z, quiet);
    }
    const std::vector<int>& row = order_.nodes.row;
    parallel_blocks(
        row.size(),
        [&](std::size_t begin, std::size_t end) {
          for (auto u = static_cast<Eigen::Index>(begin); u < static_cast<Eigen::Index>(end); ++u)
            for (Eigen::Index c = 0; c < columns; ++c) sides(u, first + c) = x(row[u], c);
        },
        quiet, rows_at_once);
    return iteration;
  }

  NodeOrder order_;
  std::unique_ptr<BlockMatrix> matrix_;
  std::optional<CoarseSpace> coarse_space_;
  IndexLists coarse_neighbours_;
  std::unique_ptr<LinearSolver> coarse_solver_;
  SolverStatistics statistics_;
  mutable std::atomic<int> iterations_ = 0;
};

}  // namespace

std::unique_ptr<LinearSolver> make_iterative_solver() { return std::make_unique<IterativeSolver>(); }

}  // namespace meshgraft
