#pragma once

#include <map>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/distributed.h>
#include <meshgraft/linalg/linear_solver.h>

#include "linalg/sparse.h"
#include "local_mesh.h"

namespace meshgraft::distributed {

/// A rank's rows of a symmetric positive definite matrix N over unknowns of all ranks.
struct MatrixRows {
  std::vector<std::int64_t> offsets{0};  ///< per own unknown
  std::vector<Number> columns;           ///< numbers of unknowns, ascending within a row
  std::vector<double> values;
};

/// Returns a rank's rows of the sum of the ranks' contributions. Each contribution is the lower triangle of a
/// symmetric matrix over the rank's local unknowns.
MatrixRows sum_contributions(const Communicator& comm, const Halo& unknowns, const NormalMatrix& lower);

/// The geometry of the unknowns of a matrix. Each belongs to a vertex.
struct UnknownNodes {
  const LocalMesh* mesh = nullptr;
  std::vector<Index> vertex;  ///< per own unknown: its local vertex, ascending
  /// Positions of the own unknowns. Vectors whose entries are an affine function of position have (nearly) no
  /// energy.
  Points positions;
  Flags has_unknowns;  ///< per local vertex
};

struct ParallelSolverOptions {
  Preconditioner preconditioner = Preconditioner::blended;
  std::string prefix;  ///< of the options of PETSc that belong to this solver
  /// Applies the preconditioner once, which is a factor. For matrices too uneven for conjugate gradients.
  bool direct = false;
};

/// Messages and bytes that PETSc sent and received on a rank, and its reductions.
struct Traffic {
  double messages = 0, bytes = 0, reductions = 0;
};

/// Figures of a solver.
struct ParallelStatistics {
  Number unknowns = 0, coarse_unknowns = 0;
  Number matrix_nonzeros = 0;  ///< of the whole symmetric matrix
  double operator_complexity = 1;
  int iterations = 0;  ///< of the latest solve
  Number all_iterations = 0,
         coarse_iterations =
             0;     ///< of all solves; those of the coarse grid column by column, 0 with its factor
  Traffic traffic;  ///< of all solves, on this rank
};

/// Solves N x = y for a few columns at once by conjugate gradients. All columns go through the matrix together,
/// as one system of interleaved vectors (PETSc's MAIJ). The preconditioner is a multigrid cycle. Its first
/// coarse grid has one affine function of position for each aggregate of vertices, blended between aggregates.
/// That grid is solved roughly, by a few iterations with PETSc's algebraic multigrid (GAMG), which begins
/// from the vectors {1, x, y, z}; so the conjugate gradients are flexible ones (Notay 2000).
class ParallelSolver {
 public:
  /// `rows` are freed before the preconditioner is set up, which takes as much memory.
  ParallelSolver(const Communicator& comm, MatrixRows rows, const UnknownNodes& nodes,
                 const ParallelSolverOptions& options);
  ParallelSolver(ParallelSolver&&) noexcept;
  ~ParallelSolver();

  /// Solves for own unknowns × k. `tolerance` is relative, in the energy norm as the preconditioner measures
  /// it. `guess` may be null. Throws Error(unsolvable) with the id linalg.not_converged on all ranks.
  Columns solve(const Columns& rhs, double tolerance, const Columns* guess) const;

  ParallelStatistics statistics() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft::distributed
