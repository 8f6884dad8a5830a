#include <cmath>
#include <numbers>
#include <numeric>

#include <Eigen/Geometry>

#include <meshgraft/mesh/normals.h>

#include "linalg/sparse.h"
#include "methods.h"
#include "operators/laplacian.h"

namespace meshgraft::baselines {

namespace {

/// Returns C (M⁻¹C)^(k−1), the symmetric form of Δᵏ with Δ = M⁻¹C: cotangent weights C over mixed areas M.
SparseRows harmonic_operator(const EditProblem& problem, const std::vector<double>& areas, int order,
                             const Context& context) {
  SparseRows power = cotangent_laplacian(problem), laplace = power;
  for (Index i = 0; i < problem.size(); ++i)
    for (SparseRows::InnerIterator entry(laplace, i); entry; ++entry) entry.valueRef() /= areas[i];
  for (int k = 1; k < order; ++k) power = multiply(power, laplace, context);
  return power;
}

/// Returns the surface without detail below `detail_size_rel` × mean edge length, or without any detail if that
/// is 0. Solves N b + μ M (b − p) = 0, which halves the amplitude of a wave of that length.
Points base_surface(const EditProblem& problem, const SparseRows& N, const std::vector<double>& areas,
                    const BaselineOptions& options, const Context& context) {
  const std::vector<double> lengths = mean_edge_lengths(problem.rest(), problem.rings);
  const double mean_length = std::accumulate(lengths.begin(), lengths.end(), 0.0) / problem.size();
  const double size = options.detail_size_rel * mean_length;
  const double mu = size > 0 ? std::pow(2 * std::numbers::pi / size, 2 * options.harmonic_order) : 0;
  SparseRows smoothing = N;
  Columns b = problem.rest();
  for (Index i = 0; i < problem.size(); ++i) {
    smoothing.coeffRef(i, i) += mu * areas[i];
    b.row(i) *= mu * areas[i];
  }
  Columns base = problem.rest();
  KnownRowsSolver(smoothing, problem.mask.position, options.backend, context)
      .solve(smoothing, b, base, context);
  return base;
}

}  // namespace

/// Solves for a Δᵏ-harmonic displacement of the base surface b. The detail p − b is kept in the local frames
/// of b.
Points deform_botsch_kobbelt_2004(const EditProblem& problem, const BaselineOptions& options,
                                  const Context& context) {
  const std::vector<double> areas = mixed_areas(problem);
  const SparseRows N = harmonic_operator(problem, areas, options.harmonic_order, context);
  const Points rest_base = base_surface(problem, N, areas, options, context);
  // Free rows of `start` hold the mean displacement of the known vertices. A constant displacement satisfies
  // every row except those beside known vertices.
  Columns displacement = problem.start - problem.rest();
  KnownRowsSolver(N, problem.mask.position, options.backend, context)
      .solve(N, Columns::Zero(problem.size(), 3), displacement, context);
  const Points edited_base = rest_base + displacement;

  const auto normals = [&](const Points& points) {
    return vertex_normals(points, problem.triangles(), problem.faces_around, context);
  };
  const std::vector<Eigen::Matrix3d> rotations =
      frame_rotations(problem, rest_base, normals(rest_base), edited_base, normals(edited_base), context);
  Points positions = edited_base;
  for (Index v = 0; v < problem.size(); ++v)
    positions.row(v) += (problem.rest().row(v) - rest_base.row(v)) * rotations[v].transpose();
  return positions;
}

}  // namespace meshgraft::baselines
