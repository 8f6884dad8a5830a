#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Lower triangle of a symmetric positive definite matrix, columns sorted, 64-bit indices.
using NormalMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

enum class SolverBackend {
  automatic,     ///< `multifrontal` where it was built in, else `eigen`
  multifrontal,  ///< our Cholesky on dense fronts; minimum degree or, for large matrices, nested dissection
  eigen,         ///< Eigen's simplicial Cholesky, approximate minimum degree
  iterative,     ///< conjugate gradients, preconditioned by two grids: for regions that no factor fits
};

struct SolverStatistics {
  std::string backend;   ///< "multifrontal", "eigen" or "iterative"
  std::string ordering;  ///< "dissection" (of a ordering graph), "metis" (of the matrix's own graph), "amd"; of
                         ///< the coarse matrix for "iterative", whose factor the next but two numbers describe
  std::int64_t unknowns = 0;
  std::int64_t matrix_nonzeros = 0;  ///< of the lower triangle
  std::int64_t factor_nonzeros = 0;
  double factor_flops = 0;
  std::int64_t peak_memory_bytes = 0;  ///< of the solver alone

  // Of "iterative" alone.
  std::int64_t coarse_unknowns = 0;
  double operator_complexity = 1;  ///< entries of all matrices over those of N
  int iterations = 0;              ///< that the latest solve took
};

/// How a graph is cut in two, its halves in two, and so on.
struct BisectionTree {
  int levels = 0;
  std::vector<int> part;  ///< of each vertex: bit `levels - 1` is its side of the first cut, bit 0 of the last
};

/// Where the unknowns of a matrix sit: a graph far smaller than the matrix's own, in which an ordering is found
/// sooner. Unknowns are coupled if their groups are the same or few edges apart.
struct OrderingGraph {
  std::vector<Index> group;                ///< of each unknown; -1 where it is coupled with groups far apart
  const IndexLists* neighbours = nullptr;  ///< of each group; none: no graph is known
  /// Kept by the caller for several systems over one graph: the first to cut it fills this, later ones use it.
  std::shared_ptr<BisectionTree> cuts{};
  /// Of each unknown (unknowns×3; rows of those without a group do not count): vectors whose entries are an
  /// affine function of them cost (nearly) nothing. Empty: that is known of constants alone.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> positions{};
};

/// How a solve may stop early; direct methods need neither.
struct SolveOptions {
  /// Of the error in the energy norm √(eᵀ N e), as the preconditioner measures it, relative to the solution's.
  double tolerance = 1e-9;
  const Eigen::MatrixXd* guess = nullptr;  ///< where to start from (unknowns×k); none: zero
};

/// Solves N x = y for a symmetric positive definite N: analyse once per pattern, factorise once per set of
/// values, solve many times. Knows nothing of meshes; a direct or an iterative method fits behind it.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Ordering and symbolic work; depends on the pattern alone, and on the graph if there is one.
  virtual void analyse(const NormalMatrix& lower, const OrderingGraph& graph = {},
                       const Context& context = {}) = 0;

  /// Numerical factor. Throws Error(unsolvable) if N is not positive definite.
  virtual void factorise(const NormalMatrix& lower, const Context& context = {}) = 0;

  /// Solves for all columns of `rhs` (unknowns×k). Safe to call from several threads at once.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const Context& context = {}) const {
    return solve(rhs, SolveOptions{}, context);
  }

  /// Throws Error(unsolvable) where an iterative method does not get there.
  virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions& options,
                                const Context& context = {}) const = 0;

  virtual SolverStatistics statistics() const = 0;
};

/// Which backends this build has, best first.
std::vector<SolverBackend> available_backends();

/// Throws Error(input) if the backend is not part of this build.
std::unique_ptr<LinearSolver> make_solver(SolverBackend backend = SolverBackend::automatic);

/// ‖N‖₁ of the whole symmetric matrix.
double one_norm(const NormalMatrix& lower);

/// Lower bound of the 1-norm condition number of the factorised N (Hager 1984, Higham 1988) from a few
/// solves; `norm` is ‖N‖₁.
double estimate_condition(double norm, const LinearSolver& solver, const Context& context = {});

}  // namespace meshgraft
