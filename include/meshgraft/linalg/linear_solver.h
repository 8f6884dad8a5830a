#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <Eigen/SparseCore>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

namespace meshgraft {

/// Lower triangle of a symmetric positive definite matrix, columns sorted, 64-bit indices.
using NormalMatrix = Eigen::SparseMatrix<double, Eigen::ColMajor, std::int64_t>;

enum class SolverBackend {
  automatic,     ///< `multifrontal` if built, else `eigen`; a Deformer may choose `iterative`
  multifrontal,  ///< our Cholesky on dense fronts; minimum degree or, for large matrices, nested dissection
  eigen,         ///< Eigen's simplicial Cholesky, approximate minimum degree
  /// Two-grid preconditioned conjugate gradients: for regions whose factor does not fit the memory.
  iterative,
};

/// Returns the name of a backend in edit files and reports: "auto", "multifrontal", "eigen" or "iterative".
std::string_view name_of(SolverBackend backend);

/// Orderings of the unknowns.
enum class Ordering {
  minimum_degree,
  nested_dissection,  ///< of the matrix's own graph, by METIS
  mesh_dissection,    ///< nested dissection of an ordering graph
};

/// Returns the name of an ordering in reports: "amd", "metis" or "dissection".
std::string_view name_of(Ordering ordering);

/// Figures of a solver. For the backend `iterative`, `ordering`, `factor_nonzeros` and `factor_flops` describe
/// the coarse matrix.
struct SolverStatistics {
  SolverBackend backend = SolverBackend::automatic;  ///< never `automatic` after `analyse`
  Ordering ordering = Ordering::minimum_degree;
  std::int64_t unknowns = 0;
  std::int64_t matrix_nonzeros = 0;  ///< non-zeros of the lower triangle
  std::int64_t factor_nonzeros = 0;
  double factor_flops = 0;
  std::int64_t peak_memory_bytes = 0;  ///< memory of the solver alone

  // Set by `iterative` only.
  std::int64_t coarse_unknowns = 0;
  double operator_complexity = 1;  ///< non-zeros of all matrices / those of N
  int iterations = 0;              ///< iterations of the latest solve
};

/// A recursive bisection of a graph: the graph is cut in two, its halves in two, and so on.
struct BisectionTree {
  int levels = 0;
  std::vector<int> part;  ///< per vertex: bit `levels - 1` is its side of the first cut, bit 0 of the last
};

/// A graph of groups of unknowns. It is far smaller than the matrix's own graph, so that an ordering is found
/// sooner. Two unknowns are coupled if their groups are the same or few edges apart.
struct OrderingGraph {
  std::vector<Index> group;                ///< per unknown: group, or -1 if coupled with groups far apart
  const IndexLists* neighbours = nullptr;  ///< per group: neighbours; null if no graph is known
  /// Bisection tree that the caller keeps for several systems over one graph. The first system that bisects
  /// the graph fills it; later ones use it.
  std::shared_ptr<BisectionTree> bisection{};
  /// Positions of the unknowns (unknowns×3); rows of unknowns without a group are ignored. Vectors whose
  /// entries are an affine function of position have (nearly) no energy. Empty: only constant vectors are
  /// known to have none.
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> positions{};
};

/// Options with which an iterative solve stops early; direct methods ignore them.
struct SolveOptions {
  /// Bound of the error in the energy norm √(eᵀ N e), as the preconditioner measures it, relative to that of
  /// the solution.
  double tolerance = 1e-9;
  const Eigen::MatrixXd* guess = nullptr;  ///< initial guess (unknowns×k); null: zero
};

/// Solves N x = y for a symmetric positive definite N. Analyse once per sparsity pattern, factorise once per
/// set of values, solve many times. The interface knows nothing of meshes, and serves direct and iterative
/// methods.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Computes the ordering and the symbolic factorisation. They depend on the pattern alone, and on the graph
  /// if there is one.
  virtual void analyse(const NormalMatrix& lower, const OrderingGraph& graph = {},
                       const Context& context = {}) = 0;

  /// Computes the numerical factorisation. Throws Error(unsolvable) with the id linalg.not_positive_definite if
  /// N is not.
  virtual void factorise(const NormalMatrix& lower, const Context& context = {}) = 0;

  /// Does the same. Empties `lower` once it has been read, for its memory, perhaps also if it throws.
  virtual void factorise_and_free(NormalMatrix& lower, const Context& context = {}) {
    factorise(lower, context);
    NormalMatrix().swap(lower);
  }

  /// Solves for all columns of `rhs` (unknowns×k) and returns unknowns×k. Safe to call from several threads
  /// at once.
  Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const Context& context = {}) const {
    return solve(rhs, SolveOptions{}, context);
  }

  /// Does the same with options. Throws Error(unsolvable) with the id linalg.not_converged where an iterative
  /// method does not converge.
  virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const SolveOptions& options,
                                const Context& context = {}) const = 0;

  /// Right-hand sides or solutions (unknowns×k), stored row by row.
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  /// Replaces right-hand sides by their solutions, if possible in place. If it throws, x is unspecified.
  virtual void solve_in_place(Rows& x, const SolveOptions& options = {}, const Context& context = {}) const {
    x = solve(x, options, context);
  }

  virtual SolverStatistics statistics() const = 0;
};

/// Returns the backends of this build, best first.
std::vector<SolverBackend> available_backends();

/// Makes a solver. Throws Error(input) with the id linalg.no_multifrontal_solver if the backend is not part of
/// this build.
std::unique_ptr<LinearSolver> make_solver(SolverBackend backend = SolverBackend::automatic);

/// Returns ‖N‖₁ of the whole symmetric matrix.
double one_norm(const NormalMatrix& lower);

/// Returns a lower bound of the 1-norm condition number of the factorised N from a few solves (Hager 1984,
/// Higham 1988). `norm` is ‖N‖₁.
double estimate_condition(double norm, const LinearSolver& solver, const Context& context = {});

/// A sparse matrix by rows; all operators have this form.
using SparseRows = Eigen::SparseMatrix<double, Eigen::RowMajor, int>;

/// Returns the better value of the environment variable OPENBLAS_CORETYPE, or an empty string if there is
/// nothing to gain or no OpenBLAS. An OpenBLAS older than the processor runs kernels for a processor of 2004,
/// and factorisation takes twice as long. OpenBLAS reads the variable when it is loaded, so the program has
/// to be started with it.
std::string better_blas_kernels();

}  // namespace meshgraft
