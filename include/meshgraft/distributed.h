#pragma once

#include <mpi.h>

#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Preconditioners of a distributed solve.
enum class Preconditioner {
  blended,  ///< multigrid that begins with blended affine maps of vertices' aggregates, and goes on with GAMG
  gamg,     ///< PETSc's algebraic multigrid alone
  hypre,    ///< BoomerAMG, if PETSc was built with hypre
  mumps,    ///< a parallel Cholesky factor, if PETSc was built with MUMPS
};

std::string_view to_string(Preconditioner value);

/// A rank's share of a mesh and of what constrains it. The ranks own consecutive ranges of the mesh's vertices,
/// in the order of the ranks. A rank may own none.
struct LocalProblem {
  Points rest;  ///< own vertices × 3, model units
  /// Triangles by the vertices' indices in the whole mesh, m×3. A triangle is at any one rank.
  Eigen::Matrix<std::int64_t, Eigen::Dynamic, 3, Eigen::RowMajor> triangles;
  Flags movable;  ///< per own vertex: 1 in the region that may move, without its fixed vertices
  /// Constraints of own vertices, at most one for each. `vertex` counts from 0 among the own ones.
  std::vector<VertexConstraint> constraints;
  std::vector<Anchor> anchors;  ///< of own vertices; likewise
};

struct DistributedOptions {
  DeformerOptions deformer;
  Preconditioner preconditioner = Preconditioner::blended;
  /// Bound of the error of a solve with all its corrections, in the energy norm, relative to the solution.
  double tolerance = 1e-8;
};

/// Figures of the set-up, over all ranks.
struct DistributedSummary {
  std::int64_t vertices = 0, faces = 0;  ///< of the whole mesh
  std::int64_t patch_vertices = 0;       ///< vertices that can influence the unknowns
  std::int64_t free_vertices = 0, degenerate_vertices = 0;
  std::int64_t unknowns = 0, coarse_unknowns = 0;
  std::int64_t matrix_nonzeros = 0;  ///< of the whole symmetric matrix
  std::int64_t largest_part = 0;     ///< own vertices of the largest part
  std::int64_t largest_halo = 0;     ///< vertices of the largest halo
  int most_neighbours = 0;           ///< the most ranks that one rank exchanges values with
  double partition_seconds = 0, assemble_seconds = 0, factorise_seconds = 0;
};

/// The work of all solves for positions.
struct DistributedWork {
  std::int64_t iterations = 0;         ///< of all solves together
  std::int64_t coarse_iterations = 0;  ///< of the coarse grid, for each column; 0 if it has a factor
  double messages = 0, bytes = 0,
         reductions = 0;  ///< sent and received in iterations, of the rank with the most
};

/// Deforms a region of a mesh that is divided among the ranks of an MPI communicator. No rank holds the whole
/// mesh. The result is that of `Deformer` up to rounding and the tolerance. All ranks construct the object and
/// call its functions together. Where one rank throws, all ranks throw the same Error.
class DistributedDeformer {
 public:
  /// Divides the mesh by PT-Scotch, assembles the rows of each part, and sets up the preconditioner. `comm`
  /// must outlive the object. Throws what the constructor of `Deformer` throws; further Error(input) for a
  /// component that is held by positions alone in a method with rotations
  /// (distributed.component_without_transform), for faces that are oriented inconsistently
  /// (distributed.inconsistent_orientation), and for a triangle of a vertex that does not exist.
  DistributedDeformer(MPI_Comm comm, const LocalProblem& problem, const DistributedOptions& options = {});
  DistributedDeformer(DistributedDeformer&&) noexcept;
  DistributedDeformer& operator=(DistributedDeformer&&) noexcept;
  ~DistributedDeformer();

  /// Returns new positions of the own vertices (own × 3) for constraints of the same vertices as in the
  /// problem, in the same order. Vertices outside the region keep their coordinates bit for bit, and those with
  /// a given position have exactly that. Fills `report` if it is not null.
  Points evaluate(std::span<const VertexConstraint> constraints, EvaluationReport* report = nullptr) const;

  const DistributedSummary& summary() const;
  /// Returns the work of all calls of `evaluate` together. All ranks call it.
  DistributedWork work() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace meshgraft
