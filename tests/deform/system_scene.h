#pragma once

#include <memory>
#include <random>
#include <span>
#include <utility>
#include <vector>

#include <meshgraft/deform/deform_problem.h>

#include "deform/setup/region_mask.h"
#include "deform/solve/constrained_system.h"
#include "deform/solve/rotation_field.h"
#include "linalg/sparse.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

/// The parts of a `Deformer`, for tests of each part alone.
namespace meshgraft::test {

/// A region of a family's mesh with its system and its field of rotations, set up as a `Deformer` does it.
struct SystemScene {
  TestMesh mesh;
  Region region;
  DeformerOptions options;
  DeformerSummary summary;
  std::unique_ptr<ConstrainedSystem> system;
  std::unique_ptr<RotationField> rotations;  ///< null for `ft05`, and if nothing is free

  SystemScene(TestMesh family, Region chosen, const DeformerOptions& with = {},
              const SystemScene* other = nullptr)
      : mesh(std::move(family)), region(std::move(chosen)), options(with) {
    const auto rest = other != nullptr ? other->system->mesh()
                                       : std::make_shared<const RestMesh>(mesh.positions, mesh.triangles);
    ConstraintList constrained;
    const ConstrainedMesh problem{rest, make_mask(mesh.size(), region, {}, constrained), region.anchors,
                                  region.features};
    system = std::make_unique<ConstrainedSystem>(problem, options, summary,
                                                 other != nullptr ? other->system.get() : nullptr, Context());
    if (options.method != DeformMethod::ft05 && system->operators() != nullptr)
      rotations = std::make_unique<RotationField>(*system, options,
                                                  summary.reused ? other->rotations.get() : nullptr, Context());
  }

  std::vector<VertexConstraint> constraints(std::span<const HandlePose> poses) const {
    std::vector<VertexConstraint> all;
    for (std::size_t h = 0; h < poses.size(); ++h) {
      const auto held = handle_constraints(region.handles[h], poses[h], {mesh.positions, Points()});
      all.insert(all.end(), held.begin(), held.end());
    }
    return all;
  }
  /// Returns the constraints of one pose for all handles.
  std::vector<VertexConstraint> all_moved(const Eigen::Affine3d& map) const {
    return constraints(std::vector(region.handles.size(), pose_of(map)));
  }
};

/// Returns a block of numbers in −1 … 1.
inline Columns any_columns(Eigen::Index rows, Eigen::Index columns, unsigned seed) {
  std::mt19937 random(seed);
  return Columns::NullaryExpr(rows, columns,
                              [&] { return static_cast<double>(random()) / 2147483648.0 - 1.0; });
}

/// Returns one map at every vertex of a patch, minus I, as the fields of maps hold it.
inline Columns constant_maps(Index vertices, const Eigen::Matrix3d& map) {
  return (map - Eigen::Matrix3d::Identity()).transpose().replicate(vertices, 1);
}

}  // namespace meshgraft::test
