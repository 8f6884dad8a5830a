#include <algorithm>
#include <limits>
#include <map>
#include <numeric>

#include <Eigen/Geometry>

#include "deform/solve/rotations.h"
#include "mesh/disjoint_sets.h"
#include "methods.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// A local transform W = R S as numbers that can be averaged: the rotation vector of R, then S row by row.
using TransformRow = Eigen::Matrix<double, 1, 12>;

TransformRow to_row(const Matrix3d& W) {
  const Matrix3d R = nearest_rotation(W);  // S contains any reflection
  const Matrix3d S = R.transpose() * W;
  const Eigen::AngleAxisd rotation(R);
  TransformRow row;
  row << (rotation.angle() * rotation.axis()).transpose(), S.row(0), S.row(1), S.row(2);
  return row;
}

Matrix3d to_transform(const TransformRow& row) {
  const Vector3d turn = row.head<3>().transpose();
  const double angle = turn.norm();
  Matrix3d S;
  S << row.segment<3>(3), row.segment<3>(6), row.segment<3>(9);
  return angle > 0 ? Matrix3d(Eigen::AngleAxisd(angle, turn / angle) * S) : S;
}

/// Returns the known transforms as rows; the rows of other vertices are I.
Columns known_rows(const EditProblem& problem) {
  Columns rows(problem.size(), 12);
  for (Index v = 0; v < problem.size(); ++v) rows.row(v) = to_row(problem.transforms[v]);
  return rows;
}

/// Returns the vertices with a known transform in groups. One group is at rest; the others are the
/// edge-connected sets of the remaining vertices.
std::vector<std::vector<Index>> constrained_groups(const EditProblem& problem) {
  const auto at_rest = [&](Index v) { return problem.transforms[v] == Matrix3d::Identity(); };
  DisjointSets sets(problem.size());
  for (Index v = 0; v < problem.size(); ++v)
    for (Index w : problem.rings[v])
      if (problem.mask.transform[v] && problem.mask.transform[w] && !at_rest(v) && !at_rest(w))
        sets.unite(v, w);
  std::map<Index, std::vector<Index>> groups;
  for (Index v = 0; v < problem.size(); ++v)
    if (problem.mask.transform[v]) groups[at_rest(v) ? -1 : sets.root(v)].push_back(v);
  std::vector<std::vector<Index>> lists;
  for (auto& [root, vertices] : groups) lists.push_back(std::move(vertices));
  return lists;
}

/// Returns for each vertex the seed nearest to it along edges, or -1.
std::vector<Index> nearest_seeds(const EditProblem& problem, const std::vector<Index>& seeds,
                                 const std::vector<double>& distance) {
  std::vector<Index> order(distance.size()), nearest(distance.size(), -1);
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return distance[a] < distance[b]; });
  for (Index v : seeds) nearest[v] = v;
  for (Index v : order) {
    if (nearest[v] >= 0) continue;
    double shortest = std::numeric_limits<double>::infinity();
    for (Index w : problem.rings[v]) {
      const double length = distance[w] + (problem.rest().row(v) - problem.rest().row(w)).norm();
      if (nearest[w] < 0 || !(length < shortest)) continue;
      shortest = length;
      nearest[v] = nearest[w];
    }
  }
  return nearest;
}

/// Blends at each vertex the transforms of the nearest vertex of every group, weighted by inverse distance.
/// Between two groups the influence falls linearly from one to the other (the paper's section 3.2).
Columns propagate_by_distance(const EditProblem& problem) {
  const Columns known = known_rows(problem);
  Columns sums = Columns::Zero(problem.size(), 12);
  std::vector<double> weights(problem.mask.position.size(), 0.0);
  for (const std::vector<Index>& group : constrained_groups(problem)) {
    const std::vector<double> distance = edge_distance(group, problem.rest(), problem.rings);
    const std::vector<Index> nearest = nearest_seeds(problem, group, distance);
    for (Index v = 0; v < problem.size(); ++v) {
      if (nearest[v] < 0) continue;
      const double weight = 1 / std::max(distance[v], 1e-9);
      sums.row(v) += weight * known.row(nearest[v]);
      weights[v] += weight;
    }
  }
  for (Index v = 0; v < problem.size(); ++v)
    sums.row(v) =
        problem.mask.transform[v] || weights[v] == 0 ? known.row(v) : (sums.row(v) / weights[v]).eval();
  return sums;
}

/// Flags the vertices with a known transform, and those whose component has none, which keep I.
Flags settled_transforms(const EditProblem& problem) {
  DisjointSets sets(problem.size());
  for (Index v = 0; v < problem.size(); ++v)
    for (Index w : problem.rings[v]) sets.unite(v, w);
  Flags has_known(problem.mask.transform.size(), 0), settled = problem.mask.transform;
  for (Index v = 0; v < problem.size(); ++v)
    if (problem.mask.transform[v]) has_known[sets.root(v)] = 1;
  for (Index v = 0; v < problem.size(); ++v)
    if (!has_known[sets.root(v)]) settled[v] = 1;
  return settled;
}

/// Interpolates each number of the transforms by a harmonic function on the surface.
Columns propagate_harmonically(const EditProblem& problem, SolverBackend backend, const Context& context) {
  Columns rows = known_rows(problem);
  const Flags settled = settled_transforms(problem);
  if (std::all_of(settled.begin(), settled.end(), [](std::uint8_t flag) { return flag; })) return rows;
  const SparseRows C = cotangent_laplacian(problem);
  KnownRowsSolver(C, settled, backend, context).solve(C, Columns::Zero(C.rows(), 12), rows, context);
  return rows;
}

/// The Poisson equation div ∇x = div g with g the transformed gradients, per face (the paper's equations 1 to
/// 5). With linear elements both sides are sums over the edges of the faces, weighted by the opposite
/// cotangents.
class PoissonSystem {
 public:
  explicit PoissonSystem(const EditProblem& problem)
      : problem_(problem), weights_(problem.triangles().rows(), 3) {
    const Triangles& triangles = problem.triangles();
    std::vector<Eigen::Triplet<double>> entries;
    for (Index t = 0; t < triangles.rows(); ++t) {
      // The form is the Dirichlet energy of the faces and so never negative. A small uniform weight, added on
      // both sides, keeps it definite at degenerate faces.
      weights_.row(t) = half_cotangents(problem.rest(), triangles, t).transpose().array() + 1e-8;
      for (int k = 0; k < 3; ++k) {
        const Index i = triangles(t, (k + 1) % 3), j = triangles(t, (k + 2) % 3);
        if (i == j) continue;
        entries.emplace_back(i, i, weights_(t, k));
        entries.emplace_back(j, j, weights_(t, k));
        entries.emplace_back(i, j, -weights_(t, k));
        entries.emplace_back(j, i, -weights_(t, k));
      }
    }
    C_.resize(problem.size(), problem.size());
    C_.setFromTriplets(entries.begin(), entries.end());
  }

  const SparseRows& C() const { return C_; }

  /// Returns div g for a field of transforms at the vertices; each face takes the mean of its corners'
  /// transforms.
  Columns divergence(const Columns& transforms) const {
    const Triangles& triangles = problem_.triangles();
    Columns b = Columns::Zero(problem_.size(), 3);
    for (Index t = 0; t < triangles.rows(); ++t) {
      const TransformRow mean = (transforms.row(triangles(t, 0)) + transforms.row(triangles(t, 1)) +
                                 transforms.row(triangles(t, 2))) /
                                3;
      const Matrix3d W = to_transform(mean);
      for (int k = 0; k < 3; ++k) {
        const Index i = triangles(t, (k + 1) % 3), j = triangles(t, (k + 2) % 3);
        if (i == j) continue;
        const Eigen::RowVector3d flow =
            weights_(t, k) * (problem_.rest().row(i) - problem_.rest().row(j)) * W.transpose();
        b.row(i) += flow;
        b.row(j) -= flow;
      }
    }
    return b;
  }

 private:
  const EditProblem& problem_;
  Points weights_;  ///< faces × corners
  SparseRows C_;
};

}  // namespace

Points deform_yu_2004(const EditProblem& problem, const BaselineOptions& options, const Context& context) {
  const Columns transforms = options.propagation == Propagation::distance
                                 ? propagate_by_distance(problem)
                                 : propagate_harmonically(problem, options.backend, context);
  const PoissonSystem poisson(problem);
  Columns x = problem.start;
  KnownRowsSolver(poisson.C(), problem.mask.position, options.backend, context)
      .solve(poisson.C(), poisson.divergence(transforms), x, context);
  return x;
}

}  // namespace meshgraft::baselines
