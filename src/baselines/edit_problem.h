#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>
#include <meshgraft/operators/affine_operator.h>

#include "deform/setup/patch.h"
#include "linalg/sparse.h"

namespace meshgraft::baselines {

/// An edit as all methods see it: a patch of the free vertices and the rings around them, scaled to about
/// unit size. Every vertex that is not free has a known position. Vertices are those of the patch.
struct EditProblem {
  Patch patch;  ///< empty if no vertex is free
  IndexLists faces_around, rings;
  ConstraintMask mask;
  std::vector<Eigen::Matrix3d> transforms;  ///< known local transforms, otherwise I
  /// n×3: known vertices at their positions; free ones at rest plus the mean displacement of the known ones
  Points start;

  Index size() const { return patch.size(); }
  const Points& rest() const { return patch.points; }
  const Triangles& triangles() const { return patch.triangles; }
};

/// Checks the input and sets up the patch. The patch contains all rings up to `depth` around the free
/// vertices.
EditProblem make_problem(const DeformProblem& edit, int depth, const Context& context);

/// Returns half the cotangent of the angle at each corner. The area is taken as at least 1e-6 of the longest
/// edge squared, so that degenerate faces stay finite. Returns zero if a corner repeats.
Eigen::Vector3d half_cotangents(const Points& points, const Triangles& triangles, Index face);

/// Returns the symmetric cotangent Laplacian C, n×n: (C x)_i = Σ_j w_ij (x_i − x_j), w_ij = ½(cot α + cot β).
/// The weights are clamped to 1e-6 … 1e6, so that C is positive definite as soon as any value is known.
SparseRows cotangent_laplacian(const EditProblem& problem);

/// Returns the mixed areas of the vertices (Meyer, Desbrun, Schröder, Barr 2003), at least 1e-6 of their
/// mean.
std::vector<double> mixed_areas(const EditProblem& problem);

/// Returns for each vertex the rotation that takes its frame on one surface to its frame on another. It maps
/// normal to normal; about the normal it best aligns the edges projected into the tangent plane. I if a
/// normal is zero.
std::vector<Eigen::Matrix3d> frame_rotations(const EditProblem& problem, const Points& from,
                                             const Points& from_normals, const Points& to,
                                             const Points& to_normals, const Context& context);

/// Solves a symmetric positive semidefinite system N x = b in which some of the unknowns are known.
class KnownRowsSolver {
 public:
  /// `known` has a flag per row of N. Throws Error(unsolvable) if the unknown part is not definite.
  KnownRowsSolver(const SparseRows& N, std::span<const std::uint8_t> known, SolverBackend backend,
                  const Context& context);

  /// Solves N x = b from the values in x; known rows keep their values. The second pass corrects the first
  /// one.
  void solve(const SparseRows& N, const Columns& b, Columns& x, const Context& context, int passes = 2) const;

  /// Solves AᵀA x = Aᵀb in the same way, with the more accurate residual b − A x.
  void solve_least_squares(const SparseRows& A, const SparseRows& A_transposed, const Columns& b, Columns& x,
                           const Context& context) const;

 private:
  /// Solves for the unknown rows of the residual and adds the solution to x.
  void correct(Columns& x, const Columns& residual, const Context& context) const;

  std::vector<int> unknowns_;  ///< per unknown: its row of N
  std::unique_ptr<LinearSolver> solver_;
};

}  // namespace meshgraft::baselines
