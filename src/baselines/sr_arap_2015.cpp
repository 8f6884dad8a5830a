#include <algorithm>
#include <numeric>

#include "deform/solve/rotations.h"
#include "mesh/disjoint_sets.h"
#include "methods.h"
#include "spoke_cells.h"

namespace meshgraft::baselines {

namespace {

using Eigen::Matrix3d;

/// Returns for each vertex the area of its connected component, which is Â of the energy. Components do not
/// influence each other that way.
std::vector<double> component_areas(const EditProblem& problem) {
  DisjointSets components(problem.size());
  for (Index t = 0; t < problem.triangles().rows(); ++t)
    for (int k = 1; k < 3; ++k) components.unite(problem.triangles()(t, 0), problem.triangles()(t, k));
  std::vector<double> areas(problem.size(), 0.0);
  for (Index t = 0; t < problem.triangles().rows(); ++t) {
    const auto corner = [&](int k) -> Eigen::RowVector3d {
      return problem.rest().row(problem.triangles()(t, k));
    };
    areas[components.root(problem.triangles()(t, 0))] +=
        0.5 * (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm();
  }
  for (Index v = 0; v < problem.size(); ++v) areas[v] = areas[components.root(v)];
  return areas;
}

/// The two steps for the energy
///
///   E = Σ_k ( Σ_j w_kj ‖(x_k − x_j) − R_k (p_k − p_j)‖² + α Â Σ_l b_kl ‖R_k − R_l‖² )
///
/// over all cells k of the mesh, with j and l in the ring of k. The first sum is that of ARAP with spokes. The
/// second one penalises bending: Â is the area of the surface, so that α has no unit. The paper calls b scalar
/// weights. `uniform` takes the mean of 1/d_k and 1/d_l, where d is the number of neighbours; where all d are
/// equal, α here is half of that of CGAL's SRE_ARAP. `cotangent` takes w. The global step is that of ARAP,
/// because the second sum has no positions.
class SrArap {
 public:
  SrArap(const EditProblem& problem, const BaselineOptions& options, const Context& context)
      : cells_(problem, Flags(problem.mask.position.size(), 1), context),
        solver_(cells_.C(), problem.mask.position, options.backend, context),
        bending_(cells_.C()),
        covariances_(problem.size()),
        bending_energies_(problem.size(), 0.0) {
    const std::vector<double> areas = component_areas(problem);
    const auto share = [&](Index v) {
      return 1.0 / std::max(1.0, static_cast<double>(problem.rings[v].size()));
    };
    for (Index k = 0; k < problem.size(); ++k)
      for (SparseRows::InnerIterator entry(bending_, k); entry; ++entry) {
        const auto l = static_cast<Index>(entry.col());
        const double b =
            options.sr_weights == WeightScheme::uniform ? (share(k) + share(l)) / 2 : -entry.value();
        entry.valueRef() = l == k ? 0 : options.sr_alpha * areas[k] * b;
      }
  }

  void solve(Columns& x) const { solver_.solve(cells_.C(), cells_.right_hand_side(), x, cells_.context(), 1); }

  /// Minimises E for one rotation after the other, the others being held: R_k is nearest to
  /// Σ_j w_kj (x_k − x_j)(p_k − p_j)ᵀ + 2 α Â Σ_l b_kl R_l. Each takes the newest rotations of its neighbours,
  /// so that E falls. The order, up and down the vertices, and the number of rounds are choices made here.
  void fit_rotations(const Columns& x) {
    parallel_blocks(
        covariances_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            covariances_[k] = cells_.covariance(static_cast<Index>(k), x);
        },
        cells_.context());
    const Index n = cells_.problem().size();
    for (int round = 0; round < rounds; ++round) {
      cells_.context().throw_if_stopped();
      for (Index k = 0; k < n; ++k) fit_rotation(k);
      for (Index k = n; k-- > 0;) fit_rotation(k);
    }
  }

  double energy(const Columns& x) {
    parallel_blocks(
        bending_energies_.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k)
            bending_energies_[k] = bending_energy(static_cast<Index>(k));
        },
        cells_.context());
    return cells_.energy(x) + std::accumulate(bending_energies_.begin(), bending_energies_.end(), 0.0);
  }

 private:
  /// One round per iteration would bring rotations from the handles too slowly where bending weighs much.
  static constexpr int rounds = 10;

  void fit_rotation(Index k) {
    std::vector<Matrix3d>& R = cells_.rotations();
    Matrix3d S = covariances_[k];
    for (SparseRows::InnerIterator entry(bending_, k); entry; ++entry)
      S += 2 * entry.value() * R[static_cast<Index>(entry.col())];
    R[k] = nearest_rotation(S);
  }

  double bending_energy(Index k) const {
    const std::vector<Matrix3d>& R = cells_.rotations();
    double sum = 0;
    for (SparseRows::InnerIterator entry(bending_, k); entry; ++entry)
      sum += entry.value() * (R[k] - R[static_cast<Index>(entry.col())]).squaredNorm();
    return sum;
  }

  SpokeCells cells_;
  KnownRowsSolver solver_;
  SparseRows bending_;  ///< α Â b_kl
  std::vector<Matrix3d> covariances_;
  std::vector<double> bending_energies_;
};

}  // namespace

ArapResult deform_sr_arap_2015(const EditProblem& problem, const BaselineOptions& options,
                               const Context& context) {
  return deform_by_steps<SrArap>(problem, options, context);
}

}  // namespace meshgraft::baselines
