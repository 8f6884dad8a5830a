#include "spoke_cells.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "deform/solve/rotations.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;
using Eigen::RowVector3d;

/// Calls `body` for each neighbour of vertex i with the weight of the edge.
template <typename Body>
void for_each_spoke(const SparseRows& C, Index i, const Body& body) {
  for (SparseRows::InnerIterator entry(C, i); entry; ++entry)
    if (entry.col() != i) body(static_cast<Index>(entry.col()), -entry.value());
}

}  // namespace

Flags near_free(const EditProblem& problem) {
  const Flags& known = problem.mask.position;
  Flags near(known.size());
  for (Index i = 0; i < problem.size(); ++i)
    near[i] = !known[i] ||
              std::any_of(problem.rings[i].begin(), problem.rings[i].end(), [&](Index j) { return !known[j]; });
  return near;
}

SpokeCells::SpokeCells(const EditProblem& problem, Flags used, const Context& context)
    : problem_(problem),
      context_(context),
      C_(cotangent_laplacian(problem)),
      rotations_(problem.size(), Matrix3d::Identity()),
      cell_energies_(problem.size(), 0.0),
      used_(std::move(used)) {}

Matrix3d SpokeCells::covariance(Index i, const Columns& x) const {
  Matrix3d S = Matrix3d::Zero();
  for_each_spoke(C_, i, [&](Index j, double weight) {
    S += weight * (problem_.rest().row(i) - problem_.rest().row(j)).transpose() * (x.row(i) - x.row(j));
  });
  return S.transpose();
}

void SpokeCells::fit_rotations(const Columns& x) {
  for_each_cell(used_, context_, [&](Index i) { rotations_[i] = nearest_rotation(covariance(i, x)); });
}

Columns SpokeCells::right_hand_side() const {
  Columns b = Columns::Zero(problem_.size(), 3);
  for_each_cell(used_, context_, [&](Index i) {
    if (problem_.mask.position[i]) return;
    for_each_spoke(C_, i, [&](Index j, double weight) {
      b.row(i) += weight / 2 * (problem_.rest().row(i) - problem_.rest().row(j)) *
                  (rotations_[i] + rotations_[j]).transpose();
    });
  });
  return b;
}

double SpokeCells::energy(const Columns& x) {
  for_each_cell(used_, context_, [&](Index i) {
    cell_energies_[i] = 0;
    for_each_spoke(C_, i, [&](Index j, double weight) {
      const RowVector3d rest = problem_.rest().row(i) - problem_.rest().row(j);
      const RowVector3d misfit = x.row(i) - x.row(j) - rest * rotations_[i].transpose();
      cell_energies_[i] += weight * misfit.squaredNorm();
    });
  });
  return std::accumulate(cell_energies_.begin(), cell_energies_.end(), 0.0);
}

}  // namespace meshgraft::baselines
