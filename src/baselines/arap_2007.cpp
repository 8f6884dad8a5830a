#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "deform/solve/rotations.h"
#include "methods.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;
using Eigen::RowVector3d;

/// The local and the global step over the cells that contain a free vertex.
class Arap {
 public:
  Arap(const EditProblem& problem, const Context& context)
      : problem_(problem),
        context_(context),
        C_(cotangent_laplacian(problem)),
        rotations_(problem.size(), Matrix3d::Identity()),
        cell_energies_(problem.size(), 0.0) {
    moves_.resize(rotations_.size());
    for (Index i = 0; i < problem.size(); ++i)
      moves_[i] = !problem.mask.position[i] || std::any_of(problem.rings[i].begin(), problem.rings[i].end(),
                                                           [&](Index j) { return !problem.mask.position[j]; });
  }

  const SparseRows& C() const { return C_; }

  /// Fits the best rotation to each cell (equations 5 and 6).
  void fit_rotations(const Columns& x) {
    for_each_cell([&](Index i) {
      Matrix3d S = Matrix3d::Zero();
      for_each_spoke(i, [&](Index j, double weight) {
        S += weight * (problem_.rest().row(i) - problem_.rest().row(j)).transpose() * (x.row(i) - x.row(j));
      });
      rotations_[i] = nearest_rotation(S.transpose());
    });
  }

  /// Returns the right-hand side of the global step (equation 8).
  Columns right_hand_side() const {
    Columns b = Columns::Zero(problem_.size(), 3);
    for_each_cell([&](Index i) {
      if (problem_.mask.position[i]) return;
      for_each_spoke(i, [&](Index j, double weight) {
        b.row(i) += weight / 2 * (problem_.rest().row(i) - problem_.rest().row(j)) *
                    (rotations_[i] + rotations_[j]).transpose();
      });
    });
    return b;
  }

  /// Returns E of equation 3 for the rotations of the last fit.
  double energy(const Columns& x) {
    for_each_cell([&](Index i) {
      cell_energies_[i] = 0;
      for_each_spoke(i, [&](Index j, double weight) {
        const RowVector3d rest = problem_.rest().row(i) - problem_.rest().row(j);
        const RowVector3d misfit = x.row(i) - x.row(j) - rest * rotations_[i].transpose();
        cell_energies_[i] += weight * misfit.squaredNorm();
      });
    });
    double sum = 0;
    for (double part : cell_energies_) sum += part;
    return sum;
  }

 private:
  template <typename Body>
  void for_each_cell(const Body& body) const {
    parallel_blocks(
        moves_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t i = begin; i < end; ++i)
            if (moves_[i]) body(static_cast<Index>(i));
        },
        context_);
  }

  template <typename Body>
  void for_each_spoke(Index i, const Body& body) const {
    for (SparseRows::InnerIterator entry(C_, i); entry; ++entry)
      if (entry.col() != i) body(static_cast<Index>(entry.col()), -entry.value());
  }

  const EditProblem& problem_;
  const Context& context_;
  SparseRows C_;
  std::vector<Matrix3d> rotations_;
  std::vector<double> cell_energies_;
  Flags moves_;  ///< per cell: whether it has a free vertex
};

}  // namespace

ArapResult deform_arap_2007(const EditProblem& problem, const BaselineOptions& options,
                            const Context& context) {
  const NaiveLaplacian laplacian(problem, WeightScheme::cotangent, options.backend, context);
  Columns x = laplacian.solve(laplacian.delta(), context);

  Arap arap(problem, context);
  const KnownRowsSolver solver(arap.C(), problem.mask.position, options.backend, context);
  arap.fit_rotations(x);
  ArapResult result;
  result.energies.push_back(arap.energy(x));
  for (int iteration = 0; iteration < options.arap_iterations; ++iteration) {
    context.step("iterate", static_cast<double>(iteration) / options.arap_iterations);
    solver.solve(arap.C(), arap.right_hand_side(), x, context, 1);
    arap.fit_rotations(x);
    const double before = result.energies.back(), after = arap.energy(x);
    result.energies.push_back(after);
    if (std::abs(before - after) <= options.arap_tolerance * before) break;
  }
  result.positions = x;
  return result;
}

}  // namespace meshgraft::baselines
