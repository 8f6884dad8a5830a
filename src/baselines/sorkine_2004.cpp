#include <algorithm>
#include <set>

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>

#include <meshgraft/core/error.h>

#include "baselines/facts.h"
#include "deform/solve/rotations.h"
#include "linalg/sparse.h"
#include "mesh/disjoint_sets.h"
#include "methods.h"
#include "operators/laplacian.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

/// Returns the pseudo-inverse. It is zero in the directions that a ring on one line leaves undetermined.
Matrix3d pseudo_inverse(const Matrix3d& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(symmetric);
  const double least = 1e-12 * std::max(eigen.eigenvalues()[2], 1e-300);
  const Vector3d inverse = eigen.eigenvalues().unaryExpr([&](double e) { return e > least ? 1 / e : 0.0; });
  return eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose();
}

/// The linearised similarity T_i = s I + [h]× that best fits vertex i and its ring (the paper's equations 8
/// to 11). It is linear in the new positions x_k, so that T_i δ_i = Σ_k B_k x_k. With q_k the old positions
/// minus their mean, s = Σ q_k·x_k / Σ |q_k|² and h = J⁻¹ Σ q_k × x_k, J = Σ (|q_k|² I − q_k q_kᵀ). The full
/// system decouples into s, h and the translation because Σ q_k = 0.
class TransformedDetail {
 public:
  TransformedDetail(const EditProblem& problem, Index i, const Vector3d& delta) : delta_(delta) {
    const auto ring = problem.rings[i];
    nodes.assign(ring.begin(), ring.end());
    nodes.push_back(i);
    Vector3d mean = Vector3d::Zero();
    for (Index k : nodes) mean += problem.rest().row(k).transpose() / static_cast<double>(nodes.size());
    Matrix3d J = Matrix3d::Zero();
    for (Index k : nodes) {
      const Vector3d q = problem.rest().row(k).transpose() - mean;
      offsets_.push_back(q);
      squares_ += q.squaredNorm();
      J += q.squaredNorm() * Matrix3d::Identity() - q * q.transpose();
    }
    turn_ = -cross_matrix(delta) * pseudo_inverse(J);
  }

  Matrix3d B(std::size_t k) const {
    if (!(squares_ > 0)) return Matrix3d::Zero();
    return delta_ * offsets_[k].transpose() / squares_ + turn_ * cross_matrix(offsets_[k]);
  }

  std::vector<Index> nodes;  ///< the ring, then i

 private:
  Vector3d delta_;
  std::vector<Vector3d> offsets_;
  double squares_ = 0;
  Matrix3d turn_;
};

/// Returns the rows D x_i − T_i(x) δ_i that contain a free vertex, 3n × 3n, for x = (x_1, y_1, z_1, x_2, …).
SparseRows edit_rows(const EditProblem& problem, WeightScheme weights, const Context& context) {
  const SparseRows D = umbrella_operator(problem.rest(), problem.triangles(), problem.rings, weights, context);
  const Columns delta = multiply(D, Columns(problem.rest()), context);
  std::vector<Eigen::Triplet<double>> entries;
  for (Index i = 0; i < problem.size(); ++i) {
    const TransformedDetail detail(problem, i, delta.row(i).transpose());
    if (std::all_of(detail.nodes.begin(), detail.nodes.end(),
                    [&](Index k) { return problem.mask.position[k]; }))
      continue;
    for (SparseRows::InnerIterator entry(D, i); entry; ++entry)
      for (int c = 0; c < 3; ++c)
        entries.emplace_back(3 * i + c, 3 * static_cast<int>(entry.col()) + c, entry.value());
    for (std::size_t k = 0; k < detail.nodes.size(); ++k) {
      const Matrix3d B = detail.B(k);
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) entries.emplace_back(3 * i + r, 3 * detail.nodes[k] + c, -B(r, c));
    }
  }
  SparseRows A(3 * problem.size(), 3 * problem.size());
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}

/// Returns whether the points lie on one line, or are fewer than two.
bool collinear(const Points& points, const std::set<Index>& vertices) {
  Vector3d mean = Vector3d::Zero();
  for (Index v : vertices) mean += points.row(v).transpose() / static_cast<double>(vertices.size());
  Matrix3d scatter = Matrix3d::Zero();
  for (Index v : vertices) {
    const Vector3d q = points.row(v).transpose() - mean;
    scatter += q * q.transpose();
  }
  const Vector3d sigma = Eigen::JacobiSVD<Matrix3d>(scatter).singularValues();
  return sigma[1] <= 1e-12 * sigma[0];
}

/// Requires three known positions not on one line. A similarity has seven degrees of freedom, and known
/// positions on one line leave the rotation about the line open.
void require_fixed_similarity(const EditProblem& problem) {
  DisjointSets sets(problem.size());
  for (Index v = 0; v < problem.size(); ++v)
    for (Index w : problem.rings[v])
      if (!problem.mask.position[v] && !problem.mask.position[w]) sets.unite(v, w);
  std::vector<std::set<Index>> seen(
      problem.mask.position.size());  // known vertices in the rows of each component
  for (Index v = 0; v < problem.size(); ++v) {
    if (problem.mask.position[v]) continue;
    for (Index w : problem.rings[v]) {
      if (!problem.mask.position[w]) continue;
      std::set<Index>& places = seen[sets.root(v)];
      places.insert(w);
      for (Index u : problem.rings[w])
        if (problem.mask.position[u]) places.insert(u);
    }
  }
  for (Index v = 0; v < problem.size(); ++v)
    if (!problem.mask.position[v] && sets.root(v) == v && collinear(problem.rest(), seen[v]))
      throw Error(facts::baselines::KnownPositionsOnALine{.vertex = problem.patch.vertices[v]});
}

}  // namespace

/// Minimises Σ ‖D x_i − T_i(x) δ_i‖² with one system for x, y and z (the paper's equation 5).
Points deform_sorkine_2004(const EditProblem& problem, const BaselineOptions& options, const Context& context) {
  require_fixed_similarity(problem);
  const SparseRows A = edit_rows(problem, options.sorkine_weights, context);
  const SparseRows A_transposed = transpose(A);
  Flags known;
  for (std::uint8_t flag : problem.mask.position) known.insert(known.end(), 3, flag);
  const KnownRowsSolver solver(multiply(A_transposed, A, context), known, options.backend, context);

  Columns x(3 * problem.size(), 1);
  Points::Map(x.data(), problem.size(), 3) = problem.start;
  solver.solve_least_squares(A, A_transposed, Columns::Zero(A.rows(), 1), x, context);
  return Points::Map(x.data(), problem.size(), 3);
}

}  // namespace meshgraft::baselines
