#pragma once

#include <memory>
#include <span>
#include <vector>

#include <meshgraft/deform/deformer.h>

#include "constrained_system.h"
#include "surface_fields.h"

namespace meshgraft {

/// Finds the field of maps F = R U (rotation, stretch) that takes the place of the identity on the right-hand
/// side of a `ConstrainedSystem`, so that large turns do not shrink the surface. The matrix stays the same.
class RotationField {
 public:
  /// `system` must outlive it. `other` is of a system that `system` shares its patch with, or none.
  RotationField(const ConstrainedSystem& system, const DeformerOptions& options, const RotationField* other,
                const Context& context);

  struct Result {
    ConstrainedSystem::Problem problem;  ///< the field, and what the last step solved for
    int iterations = 0;                  ///< co-rotational steps that were made
    double change = 0;                   ///< that the last of them asked for, radians (root mean square)
    bool linear = false;  ///< a constraint reflects or flattens, so that there are no logarithms to blend
  };
  Result find(std::span<const VertexConstraint> constraints, const Context& context) const;

  const SurfaceFields& fields() const { return fields_; }
  const Points& normals() const { return *normals_; }  ///< of the patch at rest
  int iterations() const { return iterations_; }       ///< co-rotational steps at the most

 private:
  static std::shared_ptr<const BendingMatrix> bending_matrix(const ConstrainedSystem& system,
                                                             const RotationField* other,
                                                             const Context& context);
  /// What the constraints alone say of each vertex: F = rotation · stretch.
  struct Blend {
    std::vector<Eigen::Matrix3d> rotation, stretch;
    std::vector<Eigen::Vector3d> feature_turn;  ///< rotation vector of each feature, with all its turns
  };
  /// Of the features; empty: not known yet, and the mean of the constraints' in `blend`.
  using FeatureMaps = std::vector<Eigen::Matrix3d>;
  std::vector<Eigen::Matrix<double, 1, 9>> mean_logs_around_features(const Columns& logs) const;
  bool impose_on_features(const FeatureMaps& maps, const Eigen::Matrix3d& reference, Columns& logs,
                          Blend& blended) const;
  bool blend(std::span<const VertexConstraint> constraints, const FeatureMaps& features, Blend& blended,
             const Context& context) const;
  std::vector<Eigen::Matrix3d> fitted_maps(std::span<const VertexConstraint> constraints) const;
  MapField linear_field(std::span<const VertexConstraint> constraints, const Context& context) const;
  MapField compose(const Blend& blended, const Columns& deviation, const Context& context) const;
  bool local_steps(std::span<const VertexConstraint> constraints, Blend& blended, Result& result,
                   const Context& context) const;
  Columns surface_deviation(const Columns& maps, const Blend& blended, const Columns& current,
                            const Context& context) const;
  double root_mean_square(const Columns& deviation) const;

  const ConstrainedSystem& system_;
  bool has_features_ = false;
  int iterations_ = 0;
  SurfaceFields fields_;
  std::shared_ptr<const Points> normals_;  ///< of the patch at rest
};

}  // namespace meshgraft
