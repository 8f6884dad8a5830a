#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/QR>
#include <Eigen/SparseCore>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/options.h>

namespace meshgraft::test {

/// What the energy depends on.
struct OracleProblem {
  Points rest;                                ///< n×3
  std::optional<Points> moved;                ///< n×3, p': vertices moved off their plane; else rest
  Triangles triangles;                        ///< m×3
  std::vector<VertexConstraint> constraints;  ///< as the product takes them; all other vertices are free
  WeightScheme weights = WeightScheme::uniform;
  Density density = Density::ft05;
  double laplacian_weight = 1;   ///< λ of λ E_L + E_R
  bool apex = false;             ///< the virtual apex; else plain stencils
  double apex_height_rel = 0.5;  ///< × mean incident edge
};

/// The method's energy, λ E_L + E_R (Fu & Tai 2005, equations 9 and 11), written from its equations for
/// checking. Nothing of it comes from the product: every local map is fitted by QR to given final positions,
/// and the two sums are taken as they stand.
class Oracle {
 public:
  explicit Oracle(OracleProblem problem);

  /// All rows at final positions `x` and apexes `a` (both n×3; rows of vertices without an apex count for
  /// nothing). Known positions and transforms take the place of those given and fitted.
  Eigen::MatrixXd residuals(const Points& x, const Points& a) const;

  /// E at final vertex positions (x', where vertices were moved); the apexes are where they make it smallest.
  double energy(const Points& x) const;

  /// Norm of the gradient of E with respect to the free positions, relative to the size of the terms that
  /// have to cancel in it: ‖Jᵀ r‖ / ‖|J|ᵀ |r|‖, in 0 … 1. 0 where all rows vanish.
  double relative_gradient(const Points& x) const;

  /// Positions that make E smallest, by dense QR of all rows (some 200 vertices at the most): x', where
  /// vertices were moved.
  Points dense_minimum() const;

  /// The apexes that make E smallest for given vertices.
  Points best_apexes(const Points& x) const;

  /// Equation 8: x = M (p − p') + x' for free vertices. Not every x has one x' (on a flat sheet the way back
  /// forgets what is normal to it), so `energy` and `relative_gradient` want x' where vertices were moved.
  Points moved_back(const Points& x_moved) const;

  /// Derivative of the rows by free positions (first) and apexes (after them): the same for x, y and z.
  const Eigen::SparseMatrix<double>& jacobian() const { return jacobian_; }

  std::span<const Index> free_vertices() const { return free_; }

 private:
  struct Pair {
    Index i, j;
  };
  using Fit = Eigen::HouseholderQR<Eigen::MatrixXd>;

  void find_rings_and_pairs();
  void measure_surface();
  void set_weights();
  void fit_at_rest();
  void build_jacobian();

  /// x_i − Σ_j w_ij x_j, 1×k.
  Eigen::RowVectorXd umbrella(Index i, const Eigen::MatrixXd& x) const;
  /// The directions d of a pair's rows (M_i − M_j) d.
  std::vector<Eigen::Vector3d> directions(const Pair& pair) const;
  double row_scale(Index i) const;
  double row_scale(const Pair& pair) const;

  /// {i} ∪ N(i), then the apex if there is one, all centred on the mean of the ring; |S|×k.
  Eigen::MatrixXd centred_stencil(Index i, const Eigen::MatrixXd& x, const Eigen::MatrixXd& a) const;
  /// The transpose (3×k) of M_i: the known one, or the one fitted to the stencil.
  Eigen::MatrixXd local_map(Index i, const Eigen::MatrixXd& x, const Eigen::MatrixXd& a,
                            bool homogeneous) const;
  /// All rows, for any number k of columns. Homogeneous: as if all that is known were zero.
  Eigen::MatrixXd rows(const Eigen::MatrixXd& x, const Eigen::MatrixXd& a, bool homogeneous) const;
  Points with_known_positions(Points x) const;
  /// x and a put together from the columns' values.
  void scatter(const Eigen::MatrixXd& unknowns, Eigen::MatrixXd& x, Eigen::MatrixXd& a) const;

  OracleProblem problem_;
  Points p_;  // p' where vertices were moved, else p
  Index count_ = 0;
  std::vector<std::vector<Index>> ring_;
  std::vector<std::vector<double>> weight_;  // w_ij, beside ring_
  std::vector<Pair> pairs_;
  std::vector<std::optional<Eigen::Vector3d>> known_position_;
  std::vector<std::optional<Eigen::Matrix3d>> known_transform_;
  std::vector<Index> free_, apex_owner_;
  std::vector<bool> has_apex_;
  Points normal_, apex_rest_;
  Eigen::VectorXd mean_edge_;
  std::vector<Fit> fit_;
  Eigen::SparseMatrix<double> jacobian_;
};

}  // namespace meshgraft::test
