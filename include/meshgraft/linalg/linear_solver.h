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
  automatic,  ///< CHOLMOD where it was built in, else Eigen
  cholmod,    ///< supernodal Cholesky (SuiteSparse), minimum degree or, for large matrices, nested dissection
  eigen,      ///< Eigen's simplicial Cholesky, approximate minimum degree
};

struct SolverStatistics {
  std::string backend;   ///< "cholmod" or "eigen"
  std::string ordering;  ///< "dissection" (of a coupling graph), "metis" (of the matrix's own graph), "amd"
  std::int64_t unknowns = 0;
  std::int64_t matrix_nonzeros = 0;  ///< of the lower triangle
  std::int64_t factor_nonzeros = 0;
  double factor_flops = 0;
  std::int64_t peak_memory_bytes = 0;  ///< of the solver alone
};

/// How a graph is cut in two, its halves in two, and so on.
struct GraphCuts {
  int levels = 0;
  std::vector<int> part;  ///< of each vertex: bit `levels - 1` is its side of the first cut, bit 0 of the last
};

/// Where the unknowns of a matrix sit: a graph far smaller than the matrix's own, in which an ordering is found
/// sooner. Unknowns are coupled if their groups are the same or few edges apart.
struct CouplingGraph {
  std::vector<Index> group;                ///< of each unknown; -1 where it is coupled with groups far apart
  const IndexLists* neighbours = nullptr;  ///< of each group; none: no graph is known
  /// Kept by the caller for several systems over one graph: the first to cut it fills this, later ones use it.
  std::shared_ptr<GraphCuts> cuts{};
};

/// Solves N x = y for a symmetric positive definite N: analyse once per pattern, factorise once per set of
/// values, solve many times. Knows nothing of meshes; a direct or an iterative method fits behind it.
class LinearSolver {
 public:
  virtual ~LinearSolver() = default;

  /// Ordering and symbolic work; depends on the pattern alone, and on the graph if there is one.
  virtual void analyse(const NormalMatrix& lower, const CouplingGraph& graph = {},
                       const Context& context = {}) = 0;

  /// Numerical factor. Throws Error(unsolvable) if N is not positive definite.
  virtual void factorise(const NormalMatrix& lower, const Context& context = {}) = 0;

  /// Solves for all columns of `rhs` (unknowns×k). Safe to call from several threads at once.
  virtual Eigen::MatrixXd solve(const Eigen::MatrixXd& rhs, const Context& context = {}) const = 0;

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
