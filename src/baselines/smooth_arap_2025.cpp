#include <cmath>
#include <numeric>

#include "core/parallel.h"
#include "deform/solve/rotations.h"
#include "methods.h"
#include "spoke_cells.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;
using Eigen::RowVector3d;
using Eigen::Vector3d;

/// The two steps for the energy
///
///   E = (1 − λ) E_ARAP + λ E_smooth,  E_smooth = Σ_i A_i ‖ℓ'_i − R_i ℓ_i‖²,  ℓ = A⁻¹ L p,  ℓ' = A⁻¹ L x,
///
/// with L the cotangent Laplacian and A the mixed areas of the vertices. E_ARAP has the edges of all triangles
/// around each vertex ("spokes and rims", Chao et al. 2010): Σ_i Σ_t Σ_e w_e/3 ‖e' − R_i e‖², w_e = ½ cot of
/// the angle opposite to the edge e in the triangle t. The global step solves
///
///   ((1 − λ) L + λ L A⁻¹ L) x = (1 − λ) b + λ L r,  r_i = R_i ℓ_i.
///
/// The unit of A is a choice made here: the mean of A is 1, so that λ has no unit. The smooth term then acts
/// over a length of some edges, and the result depends on the mesh, which the paper calls a limitation.
class SmoothArap {
 public:
  SmoothArap(const EditProblem& problem, const BaselineOptions& options, const Context& context)
      : problem_(problem),
        context_(context),
        lambda_(options.smoothness),
        fit_(options.smooth_arap_fit),
        used_(near_free(problem)),
        areas_(mean_one(mixed_areas(problem))),
        rotations_(problem.size(), Matrix3d::Identity()),
        cell_energies_(problem.size(), 0.0) {
    for (Index t = 0; t < problem.triangles().rows(); ++t)
      weights_.emplace_back(half_cotangents(problem.rest(), problem.triangles(), t).array() + least_weight);
    take_over(L_, laplacian());
    SparseRows scaled = L_;
    for (Index i = 0; i < problem.size(); ++i)
      for (SparseRows::InnerIterator entry(scaled, i); entry; ++entry) entry.valueRef() /= areas_[i];
    take_over(N_, multiply(L_, scaled, context));
    N_ = lambda_ * N_ + (1 - lambda_) * L_;
    ell_ = laplacian_vectors(problem.rest());
    solver_ = std::make_unique<KnownRowsSolver>(N_, problem.mask.position, options.backend, context);
  }

  void solve(Columns& x) const { solver_->solve(N_, right_hand_side(), x, context_, 1); }

  void fit_rotations(const Columns& x) {
    const Columns ell = laplacian_vectors(x);
    for_each_cell(used_, context_, [&](Index i) {
      Matrix3d S = Matrix3d::Zero();
      for_each_edge(i, [&](Index j, Index k, double weight) {
        S += weight / 3 * (x.row(j) - x.row(k)).transpose() * (problem_.rest().row(j) - problem_.rest().row(k));
      });
      if (fit_ == RotationFit::energy)
        S = (1 - lambda_) * S + lambda_ * areas_[i] * ell.row(i).transpose() * ell_.row(i);
      rotations_[i] = nearest_rotation(S);
    });
  }

  double energy(const Columns& x) {
    const Columns ell = laplacian_vectors(x);
    for_each_cell(used_, context_, [&](Index i) {
      const Matrix3d R = rotations_[i].transpose();
      double rigid = 0;
      for_each_edge(i, [&](Index j, Index k, double weight) {
        const RowVector3d rest = problem_.rest().row(j) - problem_.rest().row(k);
        rigid += weight / 3 * (x.row(j) - x.row(k) - rest * R).squaredNorm();
      });
      const double smooth = areas_[i] * (ell.row(i) - ell_.row(i) * R).squaredNorm();
      cell_energies_[i] = (1 - lambda_) * rigid + lambda_ * smooth;
    });
    return std::accumulate(cell_energies_.begin(), cell_energies_.end(), 0.0);
  }

 private:
  /// The weights are raised by this, which is small beside those of sound triangles, so that L is definite on
  /// degenerate ones. The sum over the edges of a triangle is never negative, whatever its angles.
  static constexpr double least_weight = 1e-6;

  static std::vector<double> mean_one(std::vector<double> areas) {
    const double mean = std::accumulate(areas.begin(), areas.end(), 0.0) / static_cast<double>(areas.size());
    for (double& area : areas) area /= mean;
    return areas;
  }

  SparseRows laplacian() const {
    std::vector<Eigen::Triplet<double>> entries;
    for (Index t = 0; t < problem_.triangles().rows(); ++t)
      for_each_edge_of(t, [&](Index i, Index j, double weight) {
        entries.emplace_back(i, i, weight);
        entries.emplace_back(j, j, weight);
        entries.emplace_back(i, j, -weight);
        entries.emplace_back(j, i, -weight);
      });
    SparseRows L(problem_.size(), problem_.size());
    L.setFromTriplets(entries.begin(), entries.end());
    return L;
  }

  Columns laplacian_vectors(const Columns& x) const {
    Columns ell = multiply(L_, x, context_);
    for (Index i = 0; i < problem_.size(); ++i) ell.row(i) /= areas_[i];
    return ell;
  }

  Columns right_hand_side() const {
    Columns r = Columns::Zero(problem_.size(), 3), b = r;
    for_each_cell(used_, context_, [&](Index i) {
      r.row(i) = ell_.row(i) * rotations_[i].transpose();
      if (problem_.mask.position[i]) return;
      for (const Index t : problem_.faces_around[i]) {
        Matrix3d R = Matrix3d::Zero();
        for (int corner = 0; corner < 3; ++corner) R += rotations_[problem_.triangles()(t, corner)] / 3;
        for_each_edge_of(t, [&](Index j, Index k, double weight) {
          if (j != i && k != i) return;
          const RowVector3d rest = problem_.rest().row(i) - problem_.rest().row(j == i ? k : j);
          b.row(i) += weight * rest * R.transpose();
        });
      }
    });
    return lambda_ * multiply(L_, r, context_) + (1 - lambda_) * b;
  }

  template <typename Body>
  void for_each_edge_of(Index t, const Body& body) const {
    for (int corner = 0; corner < 3; ++corner) {
      const Index i = problem_.triangles()(t, (corner + 1) % 3), j = problem_.triangles()(t, (corner + 2) % 3);
      if (i != j) body(i, j, weights_[t][corner]);
    }
  }

  template <typename Body>
  void for_each_edge(Index i, const Body& body) const {
    for (const Index t : problem_.faces_around[i]) for_each_edge_of(t, body);
  }

  const EditProblem& problem_;
  const Context& context_;
  double lambda_;
  RotationFit fit_;
  Flags used_;                     ///< per cell: whether it has a free vertex
  std::vector<Vector3d> weights_;  ///< per triangle: w of the edge opposite to each corner
  std::vector<double> areas_;
  SparseRows L_, N_;
  Columns ell_;  ///< ℓ at rest
  std::vector<Matrix3d> rotations_;
  std::vector<double> cell_energies_;
  std::unique_ptr<KnownRowsSolver> solver_;
};

}  // namespace

ArapResult deform_smooth_arap_2025(const EditProblem& problem, const BaselineOptions& options,
                                   const Context& context) {
  return deform_by_steps<SmoothArap>(problem, options, context);
}

}  // namespace meshgraft::baselines
