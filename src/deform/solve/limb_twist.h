#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

#include "linalg/sparse.h"
#include "surface_fields.h"

namespace meshgraft {

/// A point of a surface as part of a limb.
struct LimbPoint {
  Eigen::Vector3d axis;    ///< a, of unit length, or zero beside limbs; its sign has no meaning
  Eigen::Vector3d moment;  ///< s (a × r), where s is 1 on a limb and 0 on a sheet
};

/// Finds the limbs of a surface, and the strain that a twist gives them. A field of pure rotations is no field
/// of gradients where a limb twists: the surface between two turned ends would have to shrink. A rod whose
/// sections turn by ω radians per length has the gradient R (I + ω (a × r) aᵀ) instead, where a is its axis and
/// r the offset from the centre line (Bergou et al. 2008).
///
/// Limbs are found from the vertices with a given map. Each connected group of them spreads a weight over the
/// surface. The weights change along a limb, in the direction t, and are constant around it. Means along their
/// level lines give the centre line and the axis. On a sheet, t points in all directions along a level line,
/// so that no axis stands out and the strain vanishes.
///
/// All of this depends on the surface at rest and on where maps are given, but not on a pose.
class LimbTwist {
 public:
  LimbTwist() = default;
  /// `given` flags the vertices with a given map, which `fields` must have been built with.
  LimbTwist(const FieldSurface& surface, const SurfaceFields& fields, std::span<const std::uint8_t> given,
            SolverBackend backend, const Context& context);

  /// Returns whether no vertex is on a limb. Other functions must then not be called.
  bool empty() const { return axes_.rows() == 0; }
  LimbPoint at(Eigen::Index v) const { return {axes_.row(v).transpose(), moments_.row(v).transpose()}; }
  /// Returns the rates at which fields, given in columns, change per length along the axis. Rates are means
  /// along level lines: a section turns as a whole, and rotations that differ from vertex to vertex of a rim
  /// are no twist.
  Columns slopes(const Columns& fields, const Context& context) const;

 private:
  struct Faces;
  void find_axes(const FieldSurface& surface, const SurfaceFields& fields, std::span<const std::uint8_t> given,
                 const Faces& faces, SolverBackend backend, const Context& context);
  void find_derivatives(const FieldSurface& surface, std::span<const std::uint8_t> given, const Faces& faces,
                        const Context& context);

  Points axes_, moments_, directions_;         ///< a, s (a × r) and t; the signs of a and t are arbitrary
  std::vector<Index> vertices_;                ///< with a ring: the unknowns of `means_`
  std::shared_ptr<const LinearSolver> means_;  ///< gives means along level lines
  SparseRows derivatives_;                     ///< along t, × area, zero at vertices with a given map
  Eigen::VectorXd along_axis_;                 ///< mean of (t · a)² of vertices without a given map
};

/// Returns the 3×3 matrix W with which a point of a limb is strained: W m aᵀ, with m = s (a × r).
///
/// The blended map at the point is exp(turn) · reference · stretch, and `turn` changes by `slope` per length
/// along the axis. The stretched axis is a′ ∥ U a, and ω is the part about it of the rate κ at which the
/// rotation turns. Then W m = ω a′ × U r. Where sections bend as well, ω is multiplied by (ω/κ)⁴, so that the
/// strain serves twists alone. It fades where it would shear the surface much.
Eigen::Matrix3d twist_shear(const LimbPoint& at, const Eigen::Vector3d& turn, const Eigen::Vector3d& slope,
                            const Eigen::Matrix3d& reference, const Eigen::Matrix3d& stretch);

}  // namespace meshgraft
