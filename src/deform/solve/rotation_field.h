#pragma once

#include <memory>
#include <span>
#include <vector>

#include <meshgraft/deform/deform_problem.h>

#include "constrained_system.h"
#include "corotation.h"
#include "group_weights.h"
#include "limb_twist.h"
#include "linalg/sparse.h"
#include "surface_fields.h"

namespace meshgraft {

/// Returns the surface of a system, on which its fields are sought.
FieldSurface field_surface(const ConstrainedSystem& system);

/// The strain of a surface without its rotation.
struct RestStrain {
  std::vector<Eigen::Matrix3d> stretch;  ///< per vertex of the patch; with the shear of twisted limbs
  /// Per vertex: the rotation vector per length along the limb; empty if there are no limbs.
  std::vector<Eigen::Vector3d> turning;
};

/// Finds the field of maps F = R U (rotation, stretch) that replaces the identity on the right-hand side of a
/// `ConstrainedSystem`. Large rotations then do not shrink the surface. The matrix stays the same.
class RotationField {
 public:
  /// `system` must outlive the field. `other` is null or belongs to a system with the same patch.
  RotationField(const ConstrainedSystem& system, const DeformerOptions& options, const RotationField* other,
                const Context& context);

  struct Result {
    ConstrainedSystem::Problem problem;  ///< the field, and the unknowns of the last iteration
    RestStrain strain;                   ///< of the blend, for the method `shell`; empty if it is linear
    int iterations = 0;                  ///< number of co-rotational iterations performed
    double change = 0;                   ///< root mean square change that the last iteration asked for, radians
    double position_stretch = 1;         ///< that of `EvaluationReport`
    bool linear = false;  ///< a transform has no logarithm (it reflects or flattens), so the blend is linear
  };
  /// The iterations end when the field would change by less than `settled`, in radians. They begin with local
  /// maps near the solution's if `start` has rows: those of `ConstrainedSystem::maps`.
  Result find(std::span<const VertexConstraint> constraints, const Context& context,
              double settled = settled_change, const Columns& start = {}) const;

  const SurfaceFields& fields() const { return fields_; }
  const LimbTwist& limbs() const { return limbs_; }
  const Points& normals() const { return *normals_; }  ///< Returns the normals of the patch at rest.
  int iterations() const { return iterations_; }  ///< Returns the largest number of co-rotational iterations.

 private:
  void keep_few_groups(const Context& context);
  static std::shared_ptr<const BendingMatrix> bending_matrix(const ConstrainedSystem& system,
                                                             const RotationField* other,
                                                             const Context& context);
  /// The map that the constraints alone give at each vertex: F = rotation · stretch. The stretch contains the
  /// strain of twisted limbs.
  struct Blend {
    std::vector<Eigen::Matrix3d> rotation, stretch;
    RestStrain strain;                          ///< empty unless it is kept
    std::vector<Eigen::Vector3d> feature_turn;  ///< rotation vector per feature, with all turns
  };
  /// One map per feature. If empty, the maps are unknown and `blend` uses the mean of the constraints.
  using FeatureMaps = std::vector<Eigen::Matrix3d>;
  std::vector<Eigen::Matrix<double, 1, 9>> mean_logs_around_features(const Columns& logs) const;
  bool impose_on_features(const FeatureMaps& maps, const Eigen::Matrix3d& reference, Columns& logs,
                          Blend& blended) const;
  bool blend(std::span<const VertexConstraint> constraints, const FeatureMaps& features, Blend& blended,
             const Context& context) const;
  std::vector<Eigen::Matrix3d> fitted_maps(std::span<const VertexConstraint> constraints) const;
  double position_stretch(std::span<const VertexConstraint> constraints) const;
  MapField linear_field(std::span<const VertexConstraint> constraints, const Context& context) const;
  void compose(const Blend& blended, const Columns& deviation, MapField& field, const Context& context) const;
  bool local_steps(std::span<const VertexConstraint> constraints, double settled, const Columns& start,
                   Blend& blended, Result& result, const Context& context) const;
  void surface_deviation(const Columns& maps, const Blend& blended, const Columns& current, Columns& deviation,
                         const Context& context) const;
  double mean_product(const Columns& a, const Columns& b, const Context& context) const;

  const ConstrainedSystem& system_;
  bool has_features_ = false;
  bool keeps_strain_ = false;
  int iterations_ = 0;
  bool serves_parts_ = false;  ///< whether the bending matrix is right for parts of the patch, too
  SurfaceFields fields_;
  GroupWeights groups_;  ///< of known maps; empty if there are many
  LimbTwist limbs_;
  Columns slopes_of_groups_;               ///< `limbs_.slopes` of their weights
  std::shared_ptr<const Points> normals_;  ///< of the patch at rest
};

}  // namespace meshgraft
