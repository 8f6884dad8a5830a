#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>

#include "core/parallel.h"
#include "methods.h"

namespace meshgraft::baselines {

/// The cells of as-rigid-as-possible modelling (Sorkine and Alexa 2007), one per vertex. Cell i contains the
/// edges from vertex i to its ring ("spokes") with their cotangent weights, and has a rotation R_i.
class SpokeCells {
 public:
  /// Only the cells that are flagged in `used` count, and have a rotation other than I.
  SpokeCells(const EditProblem& problem, Flags used, const Context& context);

  const EditProblem& problem() const { return problem_; }
  const Context& context() const { return context_; }
  /// Returns the cotangent Laplacian, whose other entries are the negative weights.
  const SparseRows& C() const { return C_; }
  const std::vector<Eigen::Matrix3d>& rotations() const { return rotations_; }
  std::vector<Eigen::Matrix3d>& rotations() { return rotations_; }

  /// Returns the matrix whose nearest rotation fits cell i best: Σ_j w_ij (x_i − x_j)(p_i − p_j)ᵀ, the
  /// transpose of the paper's S_i (equation 5).
  Eigen::Matrix3d covariance(Index i, const Columns& x) const;

  /// Fits the best rotation to each used cell (equations 5 and 6).
  void fit_rotations(const Columns& x);

  /// Returns the right-hand side of the global step, C x = b (equation 8).
  Columns right_hand_side() const;

  /// Returns E of equation 3 for the present rotations.
  double energy(const Columns& x);

 private:
  const EditProblem& problem_;
  const Context& context_;
  SparseRows C_;
  std::vector<Eigen::Matrix3d> rotations_;
  std::vector<double> cell_energies_;
  Flags used_;
};

/// Returns a flag per vertex: whether it is free or has a free neighbour.
Flags near_free(const EditProblem& problem);

/// Calls `body(i)` for each flagged cell, in parallel.
template <class Body>
void for_each_cell(const Flags& used, const Context& context, const Body& body) {
  parallel_blocks(
      used.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i)
          if (used[i]) body(static_cast<Index>(i));
      },
      context);
}

/// Alternates the two steps of a method from the positions `start`. `steps` has the operations
/// `solve(x, …)` (the global step), `fit_rotations(x)` (the local step) and `energy(x)`.
template <class Steps>
ArapResult alternate(Steps& steps, Columns start, const BaselineOptions& options, const Context& context) {
  Columns x = std::move(start);
  steps.fit_rotations(x);
  ArapResult result;
  result.energies.push_back(steps.energy(x));
  for (int iteration = 0; iteration < options.arap_iterations; ++iteration) {
    context.step("iterate", static_cast<double>(iteration) / options.arap_iterations);
    steps.solve(x);
    steps.fit_rotations(x);
    const double before = result.energies.back(), after = steps.energy(x);
    result.energies.push_back(after);
    if (std::abs(before - after) <= options.arap_tolerance * before) break;
  }
  result.positions = x;
  return result;
}

/// Deforms by `Steps`, from the solution of the naive Laplacian.
template <class Steps>
ArapResult deform_by_steps(const EditProblem& problem, const BaselineOptions& options, const Context& context) {
  const NaiveLaplacian laplacian(problem, WeightScheme::cotangent, options.backend, context);
  Steps steps(problem, options, context);
  return alternate(steps, laplacian.solve(laplacian.delta(), context), options, context);
}

}  // namespace meshgraft::baselines
