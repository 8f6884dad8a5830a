#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <Eigen/QR>
#include <Eigen/SparseCore>

#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/operators/affine_operator.h>

namespace meshgraft::test {

/// An edge of the intrinsic Delaunay triangulation.
struct OracleEdge {
  Index i, j;
  double cotangents;  ///< ½(cot α + cot β)
};

/// The data that the energy depends on.
struct OracleProblem {
  Points rest;                  ///< n×3
  std::optional<Points> moved;  ///< n×3, p': vertices moved off their plane; else rest
  /// Moves flat vertices as FT05 equation 7 does, by the random lengths that docs/method.md states; not with
  /// `moved`.
  std::optional<std::uint64_t> noise_seed;
  Triangles triangles;                        ///< m×3
  std::vector<VertexConstraint> constraints;  ///< as for Deformer; all other vertices are free
  WeightScheme weights = WeightScheme::uniform;
  Density density = Density::ft05;
  std::vector<OracleEdge> edges;  ///< of E_R, with `apex` and `Density::aware`
  double laplacian_weight = 1;    ///< λ of λ E_L + E_R
  bool apex = false;              ///< the virtual apex; else plain stencils
  double apex_height_rel = 0.5;   ///< × mean incident edge
};

/// The method's energy, λ E_L + E_R (Fu & Tai 2005, equations 9 and 11), implemented from the equations as a
/// reference. It shares no code with the library: QR fits every local map to given final positions, and the two
/// sums are evaluated literally. With apexes and `Density::aware`, E_R is the integral of docs/method.md.
class Oracle {
 public:
  explicit Oracle(OracleProblem problem);

  /// Returns all rows at final positions `x` and apexes `a`, both n×3. Rows of `a` without an apex are ignored.
  /// Known positions and transforms replace those given and fitted.
  Eigen::MatrixXd residuals(const Points& x, const Points& a) const;

  /// Returns E at final vertex positions (x' with noise), with the apexes that minimise it.
  double energy(const Points& x) const;

  /// Returns the norm of the gradient of E with respect to the free positions, relative to the terms that must
  /// cancel in it: ‖Jᵀ r‖ / ‖|J|ᵀ |r|‖, in 0 … 1. Returns 0 if all rows vanish.
  double relative_gradient(const Points& x) const;

  /// Returns the positions that minimise E (x' with noise), by dense QR of all rows. Use it for at most about
  /// 200 vertices.
  Points dense_minimum() const;

  /// Returns the apexes that minimise E for given vertices.
  Points best_apexes(const Points& x) const;

  /// Returns x = M (p − p') + x' for free vertices (equation 8). This has no inverse, since on a flat sheet x
  /// does not depend on offsets along the normal. So `energy` and `relative_gradient` take x', not x.
  Points moved_back(const Points& x_moved) const;

  /// Returns the derivative of the rows by free positions and then apexes. It is the same for x, y and z.
  const Eigen::SparseMatrix<double>& jacobian() const { return jacobian_; }

  /// Returns p', n×3: the rest positions, where vertices were moved with their noise.
  const Points& moved() const { return p_; }
  /// Returns the fitted vertices whose stencil is wider than their ring.
  std::vector<Index> widened() const;

  std::span<const Index> free_vertices() const { return free_; }

 private:
  struct Pair {
    Index i, j;
    double weight = 0;  ///< w_ij, where E_R is an integral
  };
  using Fit = Eigen::HouseholderQR<Eigen::MatrixXd>;

  void find_rings_and_pairs();
  void measure_surface();
  void set_weights();
  void weigh_edges();
  Eigen::Vector3d place(Index i) const;
  bool is_integral() const { return problem_.apex && problem_.density == Density::aware; }
  void add_noise(std::uint64_t seed);
  void widen_stencils();
  void fit_at_rest();
  void build_jacobian();

  /// Returns x_i − Σ_j w_ij x_j, 1×k.
  Eigen::RowVectorXd umbrella(Index i, const Eigen::MatrixXd& x) const;
  /// Returns the directions d of a pair's rows (M_i − M_j) d.
  std::vector<Eigen::Vector3d> directions(const Pair& pair) const;
  double row_scale(Index i) const;
  double row_scale(const Pair& pair) const;

  /// Returns the rows of i, of its stencil's ring and of the apex, if any, relative to the mean of that ring;
  /// |S|×k.
  Eigen::MatrixXd centred_stencil(Index i, const Eigen::MatrixXd& x, const Eigen::MatrixXd& a) const;
  /// Returns the transpose (3×k) of M_i, which is known or fitted to the stencil.
  Eigen::MatrixXd local_map(Index i, const Eigen::MatrixXd& x, const Eigen::MatrixXd& a,
                            bool homogeneous) const;
  /// Returns all rows, for any number k of columns. `homogeneous` takes known transforms as zero.
  Eigen::MatrixXd rows(const Eigen::MatrixXd& x, const Eigen::MatrixXd& a, bool homogeneous) const;
  Points with_known_positions(Points x) const;
  /// Writes the values of the unknowns to the rows of x and a.
  void scatter(const Eigen::MatrixXd& unknowns, Eigen::MatrixXd& x, Eigen::MatrixXd& a) const;

  OracleProblem problem_;
  Points p_;  // p' where vertices were moved, else p
  Index count_ = 0;
  std::vector<std::vector<Index>> ring_;
  std::vector<std::vector<double>> weight_;   // w_ij, in the order of ring_
  std::vector<std::vector<Index>> fit_ring_;  // of the stencil: ring_, or more where that spans too little
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
