#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

#include "shell_surface.h"

namespace meshgraft {

/// The places of a shell's second derivatives in a matrix with three unknowns per moving vertex.
class ShellPattern {
 public:
  ShellPattern(const ShellSurface& surface, const Context& context);

  /// Returns the lower triangle with all values zero.
  const NormalMatrix& zero() const { return zero_; }
  /// Adds a 3×3 block for two unknowns, row ≥ column. The blocks of the diagonal are symmetric.
  void add(NormalMatrix& matrix, Index row, Index column, const Eigen::Matrix3d& block) const;

 private:
  std::vector<std::int64_t> begin_;  ///< per unknown: where its rows begin in `rows_`
  std::vector<Index> rows_;          ///< unknowns below the diagonal that are coupled with it, ascending
  NormalMatrix zero_;
};

/// Second derivatives of the fourth power in the Gauss-Newton model. Those of the secant lead near the minimum
/// in fewer steps; the tangent's, which are exact, reach it.
enum class CurvatureModel { secant, tangent };

/// The energy of a discrete shell (Grinspun et al. 2003) that wants to have a metric's shape, in no unit:
///
///   E = ½ Σ_e a_e s² + Σ_e g_e a_e (½ (η₂ D κ)² + ¼ (η₄ D κ)⁴) + ½ k Σ_f a_f max(0, ln 0.95 A/A′)²
///
/// Here s is the relative change of an edge's length, κ = Δθ l/A_e its change of curvature, with A_e a third of
/// the area of its two faces; a_e and a_f are shares of the area of their component, D is √(that area). The
/// fourth power spreads bends: a bend costs least where all of it is equally curved. The last term keeps faces
/// from losing their area. g rises towards held vertices.
class ShellEnergy {
 public:
  ShellEnergy(const ShellSurface& surface, const ShellPattern& pattern, ShellSurface::Metric metric);

  double value(const Points& positions, const Context& context) const;
  /// Computes the negative gradient (3 rows per moving vertex) and the second derivatives of the Gauss-Newton
  /// model, which are positive semidefinite.
  void differentiate(const Points& positions, CurvatureModel model, Eigen::VectorXd& descent,
                     NormalMatrix& curvature, const Context& context) const;
  /// Adds the matrix of factor · Σ_e ‖u_i − u_j‖² / (n_e l²), with n_e edges in the component:
  /// that of lengths, in all directions.
  void add_damping(double factor, NormalMatrix& curvature) const;
  /// Returns the ratio of each face's area to the one it wants, 1 where it wants none.
  std::vector<double> area_ratios(const Points& positions) const;

 private:
  /// Energy and derivatives by length and angle.
  struct Terms {
    double energy = 0, by_length = 0, by_length_twice = 0, by_angle = 0, by_angle_twice = 0;
  };
  double area_share(std::size_t face) const;
  Terms terms(std::size_t hinge, double length, double angle, CurvatureModel model) const;

  const ShellSurface& surface_;
  const ShellPattern& pattern_;
  ShellSurface::Metric metric_;
  std::vector<double> sizes_, hinge_counts_;  ///< per component: D, and the number of its hinges
};

}  // namespace meshgraft
