#include <meshgraft/mesh/normals.h>

#include "linalg/sparse.h"
#include "methods.h"
#include "operators/laplacian.h"

namespace meshgraft::baselines {

namespace {

/// Clears the rows without a free vertex, because they contain only known values.
void keep_rows_with_unknowns(SparseRows& D, const Flags& known) {
  Flags kept(known.size(), 0);
  for (Eigen::Index row = 0; row < D.rows(); ++row)
    for (SparseRows::InnerIterator entry(D, row); entry; ++entry)
      if (!known[entry.col()]) kept[row] = 1;
  D.prune([&](Eigen::Index row, Eigen::Index, double) { return kept[row] != 0; });
}

/// Returns vertex normals averaged over `rings` rings, by repeating an average over one ring.
Points smooth_normals(const EditProblem& problem, const Points& points, int rings, const Context& context) {
  Points normals = vertex_normals(points, problem.triangles(), problem.faces_around, context);
  for (int ring = 0; ring < rings; ++ring) {
    Points average = normals;
    for (Index v = 0; v < problem.size(); ++v)
      for (Index w : problem.rings[v]) average.row(v) += normals.row(w);
    for (Index v = 0; v < problem.size(); ++v)
      if (const double length = average.row(v).norm(); length > 0) normals.row(v) = average.row(v) / length;
  }
  return normals;
}

}  // namespace

NaiveLaplacian::NaiveLaplacian(const EditProblem& problem, WeightScheme weights, SolverBackend backend,
                               const Context& context)
    : problem_(problem),
      D_(umbrella_operator(problem.rest(), problem.triangles(), problem.rings, weights, context)) {
  keep_rows_with_unknowns(D_, problem.mask.position);
  D_transposed_ = transpose(D_);
  delta_ = multiply(D_, Columns(problem.rest()), context);
  solver_ = std::make_unique<KnownRowsSolver>(multiply(D_transposed_, D_, context), problem.mask.position,
                                              backend, context);
}

Points NaiveLaplacian::solve(const Columns& delta, const Context& context) const {
  Columns x = problem_.start;
  solver_->solve_least_squares(D_, D_transposed_, delta, x, context);
  return x;
}

/// Solves for the unrotated detail vectors, estimates the rotation of each from the smoothed result, and
/// solves for the rotated ones (the paper's section 4).
Points deform_lipman_2004(const EditProblem& problem, const BaselineOptions& options, const Context& context) {
  const NaiveLaplacian laplacian(problem, options.lipman_weights, options.backend, context);
  const Points first = laplacian.solve(laplacian.delta(), context);
  const auto normals = [&](const Points& points) {
    return smooth_normals(problem, points, options.normal_rings, context);
  };
  const std::vector<Eigen::Matrix3d> rotations =
      frame_rotations(problem, problem.rest(), normals(problem.rest()), first, normals(first), context);
  Columns delta = laplacian.delta();
  for (Index v = 0; v < problem.size(); ++v) delta.row(v) = (delta.row(v) * rotations[v].transpose()).eval();
  return laplacian.solve(delta, context);
}

}  // namespace meshgraft::baselines
