#pragma once

#include <memory>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

#include "group_weights.h"
#include "linalg/sparse.h"
#include "surface_fields.h"

namespace meshgraft {

/// A point of a surface as part of a limb or of a disc.
struct LimbPoint {
  /// a, of unit length, or zero beside both. On a limb its sign is arbitrary. On a disc it points as the
  /// normals.
  Eigen::Vector3d axis;
  Eigen::Vector3d moment;     ///< s (a × r), where s is 1 on a limb or a disc and falls to 0 beside them
  Eigen::Vector3d direction;  ///< of which rates are measured: a on a limb, t away from the centre on a disc
};

/// Returns whether the point is on a disc, and not on a limb.
inline bool is_on_disc(const LimbPoint& at) { return at.direction != at.axis; }

/// Finds the limbs of a surface, and the strain that a twist gives them. A field of pure rotations is no field
/// of gradients where a limb twists: the surface between two turned ends would have to shrink. A rod whose
/// sections turn by ω radians per length has the gradient R (I + ω (a × r) aᵀ) instead, where a is its axis and
/// r the offset from the centre line (Bergou et al. 2008).
///
/// A disc that turns within a sheet winds up the surface around it in the same way: R (I + ω (a × r) tᵀ), where
/// t points away from the disc's centre, and a is the normal of the sheet.
///
/// Limbs and discs are found from the vertices with a given map. Each connected group of them spreads a weight
/// over the surface. The weights change in the direction t, along a limb or away from a disc, and are constant
/// around either. Means along their level lines give the centre (or centre line) and the axis. On a limb, t
/// points one way along a level line, which is the axis. Around a disc it points in all directions of a plane,
/// which the axis is orthogonal to. On a cone between both, and around oblong discs, the strain vanishes.
///
/// All of this depends on the surface at rest and on where maps are given, but not on a pose.
class LimbTwist {
 public:
  LimbTwist() = default;
  /// `groups` are those of vertices with a given map. `fields` must have been built with these vertices.
  LimbTwist(const FieldSurface& surface, const SurfaceFields& fields, const GroupWeights& groups,
            SolverBackend backend, const Context& context);

  /// Returns whether no vertex is on a limb or disc. Other functions must then not be called.
  bool empty() const { return axes_.rows() == 0; }
  LimbPoint at(Eigen::Index v) const {
    return {axes_.row(v).transpose(), moments_.row(v).transpose(), rates_along_.row(v).transpose()};
  }
  /// Returns the rates at which fields, given in columns, change per length along `direction`. Rates are means
  /// along level lines: a section turns as a whole, and rotations that differ from vertex to vertex of a rim
  /// are no twist.
  Columns slopes(const Columns& fields, const Context& context) const;

 private:
  struct Faces;
  void find_axes(const FieldSurface& surface, const SurfaceFields& fields, const std::vector<Index>& group,
                 const Faces& faces, SolverBackend backend, const Context& context);
  void find_derivatives(const FieldSurface& surface, const std::vector<Index>& group, const Faces& faces,
                        const Context& context);

  Points axes_, moments_, rates_along_;        ///< the parts of `LimbPoint`
  Points directions_;                          ///< t, whose sign is arbitrary
  std::vector<Index> vertices_;                ///< with a ring: the unknowns of `means_`
  std::shared_ptr<const LinearSolver> means_;  ///< gives means along level lines
  SparseRows derivatives_;                     ///< along t, × area, zero at vertices with a given map
  Eigen::VectorXd along_axis_;                 ///< mean of (t · a)², or of 1 on discs, without given maps
};

/// A rate of turning about an axis of unit length, radians per length at rest.
struct TwistRate {
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  double rate = 0;
};

/// Returns the rate at which a limb or disc twists along its direction b.
///
/// The blended map at the point is exp(turn) · reference · stretch, and `turn` changes by `slope` per length
/// along b. The stretched axis is a′ ∥ U a, and ω is the part about it of the rate κ at which the
/// rotation turns. Where sections bend as well, ω is multiplied by (ω/κ)⁴, so that the rate is that of twists
/// alone. It fades where it would shear the surface much, and on discs also where it would shear it little.
TwistRate twist_rate(const LimbPoint& at, const Eigen::Vector3d& turn, const Eigen::Vector3d& slope,
                     const Eigen::Matrix3d& reference, const Eigen::Matrix3d& stretch);

/// Returns `TwistRate::rate` where sections turn about the axis alone, by `turning` radians per length, and
/// nothing is stretched.
double twist_rate(const LimbPoint& at, double turning);

/// Returns the 3×3 matrix W with which a point that twists is strained: W m bᵀ, with m = s (a × r) and the
/// direction b. It has W m = ω a′ × U r.
Eigen::Matrix3d twist_shear(const LimbPoint& at, const TwistRate& twist, const Eigen::Matrix3d& stretch);
/// Does the same for the `twist_rate` of a blended map.
Eigen::Matrix3d twist_shear(const LimbPoint& at, const Eigen::Vector3d& turn, const Eigen::Vector3d& slope,
                            const Eigen::Matrix3d& reference, const Eigen::Matrix3d& stretch);

/// Returns the rotation vector per length at rest by which the sections of a limb are to turn against each
/// other on a shell: all of the twist, which is that of `twist_rate`, and a share of the bend. A limb that is
/// strained by all of its bend keeps its width, but costs more than it should where it cannot be an arc.
Eigen::Vector3d wanted_turning(const LimbPoint& at, const TwistRate& twist, const Eigen::Vector3d& turn,
                               const Eigen::Vector3d& slope, const Eigen::Matrix3d& reference,
                               const Eigen::Matrix3d& stretch);

/// Returns the strain (k × U r) bᵀ of a rod whose sections turn by k per length.
Eigen::Matrix3d rod_strain(const LimbPoint& at, const Eigen::Vector3d& turning, const Eigen::Matrix3d& stretch);

}  // namespace meshgraft
