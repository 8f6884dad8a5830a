#pragma once

#include <memory>
#include <span>
#include <vector>

#include <meshgraft/deform/deformer.h>

#include "deform/coarse_start.h"
#include "deform/setup/region_mask.h"
#include "deform/solve/constrained_system.h"
#include "deform/solve/rotation_field.h"
#include "deform/solve/shell_relaxation.h"
#include "linalg/sparse.h"

namespace meshgraft {

/// The set-up of a `Deformer`, for the library's classes that are built on one. Holds the handles and checks
/// the caller's input. The `ConstrainedSystem` holds the problem itself.
struct Deformer::Impl {
  DeformerOptions options;
  SolverBackend wanted_backend = SolverBackend::automatic;  ///< as given, before one is chosen
  std::vector<Handle> handles;
  bool per_vertex = false;  ///< constraints per vertex instead of handles
  Points normals;           ///< of the rest mesh, n×3; only if a handle is a curve
  ConstraintList constrained;
  DeformerSummary summary;
  std::unique_ptr<ConstrainedSystem> system;
  std::unique_ptr<RotationField> rotations;  ///< null for `ft05`, and if nothing is free
  std::unique_ptr<ShellRelaxation> shell;    ///< of `shell` only; null if nothing is free
  std::unique_ptr<const CoarseStart> start;  ///< null where it would not help

  /// `other` is null or a set-up on the same mesh, whose parts are shared where possible.
  Impl(const std::shared_ptr<const RestMesh>& mesh, const Region& region,
       std::span<const VertexConstraint> constraints, const DeformerOptions& chosen, const Impl* other,
       const Context& context);

  /// Computes positions (n×3). Fills `solved_maps`, unless it is null, as `ConstrainedSystem::evaluate` does.
  void evaluate(std::span<const VertexConstraint> constraints, PointsRef out, EvaluationReport* report,
                Columns* solved_maps, const Context& context) const;
  /// Does what `Deformer::evaluate` does, and fills the difference M − I of each vertex's local map from I. It
  /// is zero where the map is unknown.
  Points evaluate_with_maps(std::span<const VertexConstraint> constraints,
                            std::vector<Eigen::Matrix3d>& map_changes, const Context& context,
                            EvaluationReport* report) const;

 private:
  ShellRelaxation::Result relax(const RestStrain& strain, PointsRef positions, Columns* maps,
                                const Context& context) const;
  SolverBackend choose_backends(const ConstraintMask& mask);
};

}  // namespace meshgraft
