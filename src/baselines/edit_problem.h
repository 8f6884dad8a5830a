#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/constraints.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/linalg/sparse.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/topology.h>

#include "../deform/patch.h"

namespace meshgraft::baselines {

/// An edit as all methods see it: the free vertices and the rings around them, at about unit size. All but the
/// free vertices have a known position. Vertices are the patch's.
struct EditProblem {
  Patch patch;  ///< empty where nothing is free
  IndexLists faces_around, rings;
  Flags known;                              ///< position is known
  Flags oriented;                           ///< local transform is known
  std::vector<Eigen::Matrix3d> transforms;  ///< where it is, else I
  Points start;  ///< known vertices in place; free ones at rest, moved by the known ones' mean displacement

  Index size() const { return patch.size(); }
  const Points& rest() const { return patch.points; }
  const Triangles& triangles() const { return patch.triangles; }
};

/// Checks the input and sets up the patch, whole up to `depth` rings around the free vertices.
EditProblem make_problem(const Points& rest, const Triangles& triangles, std::span<const Index> region,
                         std::span<const VertexConstraint> constraints, int depth, const Context& context);

/// Half the cotangent of the angle at each corner. The area is taken as at least 1e-6 of the longest edge
/// squared, so that faces without extent stay finite. Zero where a corner repeats.
Eigen::Vector3d half_cotangents(const Points& points, const Triangles& triangles, Index face);

/// The symmetric cotangent Laplacian C, n×n: (C x)_i = Σ_j w_ij (x_i − x_j), w_ij = ½(cot α + cot β) clamped to
/// 1e-6 … 1e6, so that C is positive definite wherever something is known.
SparseRows cotangent_laplacian(const EditProblem& problem);

/// Mixed areas of the vertices (Meyer, Desbrun, Schröder, Barr 2003), at least 1e-6 of their mean.
std::vector<double> mixed_areas(const EditProblem& problem);

/// For each vertex the rotation that takes its frame on one surface to that on another: normal to normal, and
/// about the normal so that the edges projected into the tangent plane agree best. I where a normal is zero.
std::vector<Eigen::Matrix3d> frame_rotations(const EditProblem& problem, const Points& from,
                                             const Points& from_normals, const Points& to,
                                             const Points& to_normals, const Context& context);

/// The rows of the unknowns of a symmetric positive semidefinite system N x = b whose other unknowns are known.
class KnownRowsSolver {
 public:
  /// `known` has a flag per row of N. Throws Error(unsolvable) if the unknown part is not definite.
  KnownRowsSolver(const SparseRows& N, std::span<const std::uint8_t> known, SolverBackend backend,
                  const Context& context);

  /// Solves N x = b from the values in x: known rows stay as they are. The second pass corrects the first.
  void solve(const SparseRows& N, const Columns& b, Columns& x, const Context& context, int passes = 2) const;

  /// The same for N = AᵀA and right-hand side Aᵀb, with the more accurate residual b − A x.
  void solve_least_squares(const SparseRows& A, const SparseRows& A_transposed, const Columns& b, Columns& x,
                           const Context& context) const;

 private:
  /// Adds the solution for the residual's unknown rows to those of x.
  void correct(Columns& x, const Columns& residual, const Context& context) const;

  std::vector<int> unknowns_;  ///< row of N of each unknown
  std::unique_ptr<LinearSolver> solver_;
};

}  // namespace meshgraft::baselines
