#include "deform/reduced/reduced_field.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include "deform/solve/corotation.h"
#include "deform/solve/pose_matrix.h"
#include "deform/system_scene.h"
#include "linalg/sparse.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using test::SystemScene;

constexpr Index few_centres = 6;

/// A family with two handles, or with one and a foot at rest, and the reduced field of its system.
struct ReducedScene {
  test::Scene ends;
  SystemScene full;
  ReducedField field;

  ReducedScene(const test::TestMesh& mesh, bool foot_moves, const DeformerOptions& options = {},
               bool with_transforms = true, Index centres = few_centres, Index samples_per_centre = 4)
      : ends(test::make_scene(mesh)),
        full(mesh, region_of(ends, foot_moves, with_transforms), options),
        field(*full.system, *full.rotations, full.region.handles, options, centres,
              centres * samples_per_centre, Context()) {}

  std::size_t handles() const { return full.region.handles.size(); }
  Index patch_size() const { return full.system->patch().size(); }

  /// Gives the field the maps that its coefficients cause, by one response for each.
  void set_all_maps() {
    const ConstrainedSystem& system = *full.system;
    const SparseRows cell_means = field.cell_mean_rows(3);
    const auto set_maps = [&](const Columns& maps, std::size_t first, std::size_t stride) {
      std::vector<std::size_t> rows;
      for (Eigen::Index c = 0; c < maps.cols(); ++c)
        rows.push_back(first + stride * static_cast<std::size_t>(c));
      field.set_maps(rows, multiply(cell_means, maps));
    };
    for (std::size_t number = 0; number < 2 * handles(); ++number) {
      const ReducedField::Columnwise sides = field.handle_sides(number);
      const Columns y = system.respond(sides.values, sides.field, 0, {});
      set_maps(system.maps(y, sides.values, {}), 4 * number, 1);
    }
    const auto functions = static_cast<Eigen::Index>(field.function_count());
    const ConstrainedSystem::Known none = system.no_values(functions);
    for (int axis = 0; axis < 3; ++axis) {
      MapField at_axis{Columns::Zero(3 * patch_size(), functions)};
      for (Index v = 0; v < patch_size(); ++v) at_axis.maps.row(3 * v + axis) = field.weights().row(v);
      const Columns y = system.respond(none, at_axis, 0, {});
      set_maps(system.maps(y, none, {}), 8 * handles() + static_cast<std::size_t>(axis), 3);
    }
    const auto of_twists = static_cast<Eigen::Index>(field.twist_function_count());
    const ConstrainedSystem::Known no_twists = system.no_values(of_twists);
    for (int m = 0; m < 3 && field.has_limbs(); ++m) {
      MapField strain{Columns::Zero(3 * patch_size(), of_twists)};
      for (Index v = 0; v < patch_size(); ++v)
        strain.maps.middleRows<3>(3 * v) =
            field.limbs().at(v).moment[m] * field.limbs().at(v).direction * field.twist_weights().row(v);
      const Columns y = system.respond(no_twists, strain, 0, {});
      set_maps(system.maps(y, no_twists, {}), 8 * handles() + static_cast<std::size_t>(3 * functions + m), 3);
    }
  }

  std::vector<PoseMatrix> frames(const std::vector<HandlePose>& poses) const {
    std::vector<PoseMatrix> all;
    for (const HandlePose& pose : poses)
      all.push_back(pose_matrix(pose, full.system->patch().centre, full.system->patch().scale));
    return all;
  }
  ReducedField::Result find(const std::vector<HandlePose>& poses) const {
    return field.find(poses, frames(poses).data(), {});
  }
  std::vector<HandlePose> poses_of(const Eigen::Affine3d& map) const {
    return std::vector(handles(), test::pose_of(map));
  }
  /// Returns poses that leave the foot at rest and move the head.
  std::vector<HandlePose> head_moved() const {
    std::vector<HandlePose> poses(handles());
    poses.back() = test::pose_of(test::head_move(ends));
    return poses;
  }
  Matrix3d map_at_centre(const ReducedField::Result& found, std::size_t k) const {
    const auto row = static_cast<Eigen::Index>(8 * handles() + 3 * k);
    Matrix3d map = found.coefficients.middleRows<3>(row).transpose() + Matrix3d::Identity();
    if (!field.has_limbs()) return map;
    const Index v = vertex_of_centre(k);
    const auto twist_row = static_cast<Eigen::Index>(8 * handles() + 3 * field.function_count());
    Matrix3d shear = Matrix3d::Zero();
    for (Eigen::Index f = 0; f < field.twist_weights().cols(); ++f)
      shear += field.twist_weights()(v, f) * found.coefficients.middleRows<3>(twist_row + 3 * f).transpose();
    const LimbPoint at = field.limbs().at(v);
    return map + shear * at.moment * at.direction.transpose();
  }
  auto centre_weights() const {
    return field.weights().leftCols(static_cast<Eigen::Index>(field.centre_count()));
  }
  /// Returns the vertex of the patch at which a centre's weight is 1 and those of the others are 0.
  Index vertex_of_centre(std::size_t k) const {
    for (Index v = 0; v < patch_size(); ++v)
      if (centre_weights()(v, static_cast<Eigen::Index>(k)) == 1 &&
          centre_weights().row(v).cwiseAbs().sum() == 1)
        return v;
    return -1;
  }
  /// Returns the sum of the handles' weights at each vertex of the patch, with the centres' weights beside them
  /// (first 0) or in a linear blend (first H). The weight of a handle multiplies I in its sides.
  Columns weight_of_handles(std::size_t first) const {
    Columns sum = Columns::Zero(patch_size(), 1);
    for (std::size_t h = 0; h < handles(); ++h) {
      const MapField sides = field.handle_sides(first + h).field;
      const Columns& maps = sides.maps;
      for (Index v = 0; v < patch_size(); ++v) {
        const auto block = maps.middleRows<3>(3 * v);
        EXPECT_TRUE((block - block(0, 0) * Columns::Identity(3, 4)).isZero(0));
        sum(v, 0) += block(0, 0);
      }
    }
    return sum;
  }

 private:
  static Region region_of(const test::Scene& scene, bool foot_moves, bool with_transforms) {
    Region region = foot_moves ? test::two_handles(scene) : test::held_foot(scene);
    for (Handle& handle : region.handles) handle.constrain_transform = with_transforms;
    return region;
  }
};

TEST(ReducedField, HasEightRowsPerHandleAndThreePerFunction) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const bool foot_moves : {true, false}) {
      SCOPED_TRACE(mesh.name);
      const ReducedScene scene(mesh, foot_moves);
      EXPECT_GE(scene.field.centre_count(), 1U);
      EXPECT_LE(scene.field.centre_count(), static_cast<std::size_t>(few_centres));
      EXPECT_EQ(scene.field.twist_function_count() > 0, !scene.full.rotations->limbs().empty());
      EXPECT_EQ(scene.field.width(),
                8 * scene.handles() + 3 * (scene.field.function_count() + scene.field.twist_function_count()));
      const bool has_all_vertices =
          scene.field.cell_mean_rows(1).rows() == static_cast<Eigen::Index>(scene.field.centre_count());
      EXPECT_EQ(scene.field.function_count() > scene.field.centre_count(), !has_all_vertices);
      EXPECT_EQ(scene.field.weights().rows(), scene.patch_size());
      EXPECT_EQ(scene.field.weights().cols(), static_cast<Eigen::Index>(scene.field.function_count()));
      EXPECT_EQ(scene.find(scene.head_moved()).coefficients.rows(),
                static_cast<Eigen::Index>(scene.field.width()));
    }
}

TEST(ReducedField, WeightsAreOneAtTheirOwnCentreAndZeroAtOthersAndAtGivenMaps) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const ReducedScene scene(mesh, false);
    std::vector<Index> at;
    for (std::size_t k = 0; k < scene.field.centre_count(); ++k) at.push_back(scene.vertex_of_centre(k));
    EXPECT_EQ(std::count(at.begin(), at.end(), -1), 0);
    for (Index v = 0; v < scene.patch_size(); ++v) {
      const bool is_centre = std::find(at.begin(), at.end(), v) != at.end();
      const bool is_given = scene.full.system->mask().transform[v] != 0;
      EXPECT_FALSE(is_centre && is_given);
      if (is_given) {
        EXPECT_TRUE(scene.centre_weights().row(v).isZero(0));
      }
      if (is_given || is_centre) {
        const auto winding = scene.field.weights().rightCols(
            static_cast<Eigen::Index>(scene.field.function_count() - scene.field.centre_count()));
        EXPECT_LT(winding.row(v).norm(), 1e-9);
      }
    }
  }
}

TEST(ReducedField, WeightsOfCentresAndHandlesAddUpToOne) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const ReducedScene scene(mesh, true);
    const Columns sum = scene.centre_weights().rowwise().sum() + scene.weight_of_handles(0);
    EXPECT_LT((sum.array() - 1).abs().maxCoeff(), 1e-9);
    EXPECT_LT((scene.weight_of_handles(scene.handles()).array() - 1).abs().maxCoeff(), 1e-9);
  }
}

TEST(ReducedField, WeightsOfCentresAloneAddUpToOneWithoutGivenMaps) {
  for (const test::TestMesh& mesh : {test::bumpy_sphere(2), test::tube(10, 16), test::bar(2, 9)}) {
    SCOPED_TRACE(mesh.name);
    const ReducedScene scene(mesh, true, {}, false);
    EXPECT_LT((scene.centre_weights().rowwise().sum().array() - 1).abs().maxCoeff(), 1e-9);
    EXPECT_TRUE(scene.weight_of_handles(0).isZero(0));
  }
}

TEST(ReducedField, CellMeansAreMeans) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const ReducedScene scene(mesh, false);
    const Index n = scene.patch_size();
    for (const int rows : {1, 3}) {
      const SparseRows means = scene.field.cell_mean_rows(rows);
      for (const double weight : std::vector(means.valuePtr(), means.valuePtr() + means.nonZeros()))
        EXPECT_GT(weight, 0);
      // The rows of a vertex stay apart, and each keeps a constant.
      Columns constant(rows * n, 1);
      for (Eigen::Index row = 0; row < constant.rows(); ++row)
        constant(row, 0) = static_cast<double>(5 + row % rows);
      const Columns kept = multiply(means, constant);
      for (Eigen::Index row = 0; row < kept.rows(); ++row)
        EXPECT_NEAR(kept(row, 0), static_cast<double>(5 + row % rows), 1e-12);
    }
    // A vertex lies in one cell if its map is unknown, and in none otherwise.
    const SparseRows of_vertex = transpose(scene.field.cell_mean_rows(1));
    for (Index v = 0; v < n; ++v)
      EXPECT_EQ(of_vertex.row(v).nonZeros(), scene.full.system->mask().transform[v] ? 0 : 1);
  }
}

TEST(ReducedField, RestHasNoCoefficients) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const bool foot_moves : {true, false}) {
      SCOPED_TRACE(mesh.name);
      ReducedScene scene(mesh, foot_moves);
      scene.set_all_maps();
      const ReducedField::Result found = scene.find(std::vector<HandlePose>(scene.handles()));
      EXPECT_FALSE(found.linear);
      EXPECT_LT(found.coefficients.cwiseAbs().maxCoeff(), 1e-12);
      EXPECT_EQ(found.iterations, 1);
      EXPECT_LT(found.change, 1e-12);
    }
}

TEST(ReducedField, FollowsOneMapOfAllHandles) {
  for (const test::TestMesh& mesh : test::small_families()) {
    ReducedScene scene(mesh, true);
    scene.set_all_maps();
    for (const auto& [name, linear] : test::linear_maps()) {
      if (name == "reflection") continue;
      SCOPED_TRACE(mesh.name + ", " + name);
      const ReducedField::Result found = scene.find(scene.poses_of(test::about_middle(mesh, linear)));
      EXPECT_FALSE(found.linear);
      EXPECT_EQ(found.iterations, 1) << "the first step has nothing to change";
      EXPECT_LT(found.change, 1e-6);
      for (std::size_t k = 0; k < scene.field.centre_count(); ++k)
        EXPECT_LT((scene.map_at_centre(found, k) - linear).norm(), 1e-6);
    }
  }
}

TEST(ReducedField, FitsOneMapToPositionsWithoutTransforms) {
  for (const test::TestMesh& mesh : {test::bumpy_sphere(2), test::tube(10, 16), test::bar(2, 9)})
    for (const auto& [name, linear] : test::linear_maps()) {
      SCOPED_TRACE(mesh.name + ", " + name);
      const ReducedScene scene(mesh, true, {.method = DeformMethod::rotation_aware}, false);
      const ReducedField::Result found = scene.find(scene.poses_of(test::about_middle(mesh, linear)));
      EXPECT_EQ(found.linear, linear.determinant() < 0);
      if (found.linear) continue;
      for (std::size_t k = 0; k < scene.field.centre_count(); ++k)
        EXPECT_LT((scene.map_at_centre(found, k) - linear).norm(), 1e-8);
    }
}

TEST(ReducedField, AtItsCentresIsTheBlendOfTheFullField) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const bool foot_moves : {true, false}) {
      SCOPED_TRACE(mesh.name);
      // Without samples besides the centres, the fit has no residual there.
      const ReducedScene scene(mesh, foot_moves, {.method = DeformMethod::rotation_aware}, true, few_centres,
                               1);
      std::vector<HandlePose> poses = scene.head_moved();
      if (!foot_moves)
        poses.back().rotation = Eigen::AngleAxisd(1.1 + 6.283185307179586, Vector3d(1, -2, 0.5).normalized());
      const ReducedField::Result found = scene.find(poses);
      const RotationField::Result full = scene.full.rotations->find(scene.full.constraints(poses), {});
      EXPECT_EQ(found.iterations, 0);
      for (std::size_t k = 0; k < scene.field.centre_count(); ++k) {
        const Columns& maps = full.problem.field.maps;
        const Matrix3d expected =
            maps.middleRows<3>(3 * scene.vertex_of_centre(k)).transpose() + Matrix3d::Identity();
        // The strain of twists is fitted.
        EXPECT_LT((scene.map_at_centre(found, k) - expected).norm(), scene.field.has_limbs() ? 0.02 : 1e-8);
        EXPECT_GT((expected - Matrix3d::Identity()).norm(), 1e-4);
      }
    }
}

TEST(ReducedField, WithACentreAndACellPerVertexStepsAsTheFullFieldDoes) {
  for (const test::TestMesh& mesh : {test::icosphere(1), test::grid(8, 5), test::tube(8, 8), test::bar(1, 6)}) {
    SCOPED_TRACE(mesh.name);
    ReducedScene scene(mesh, false, {}, true, 30 * few_centres);
    scene.set_all_maps();
    const std::vector<HandlePose> poses = scene.head_moved();
    const ReducedField::Result found = scene.find(poses);
    const RotationField::Result full = scene.full.rotations->find(scene.full.constraints(poses), {});
    EXPECT_EQ(found.iterations, full.iterations);
    EXPECT_NEAR(found.change, full.change, 1e-6);
    for (std::size_t k = 0; k < scene.field.centre_count(); ++k) {
      const Columns& maps = full.problem.field.maps;
      const Matrix3d expected =
          maps.middleRows<3>(3 * scene.vertex_of_centre(k)).transpose() + Matrix3d::Identity();
      EXPECT_LT((scene.map_at_centre(found, k) - expected).norm(), 1e-6);
    }
  }
}

TEST(ReducedField, CoefficientsOfHandlesAreTheirFrames) {
  Eigen::Affine3d mirror = Eigen::Affine3d::Identity();
  mirror.linear() = Vector3d(-1, 1, 1).asDiagonal();
  for (const test::TestMesh& mesh : test::small_families())
    for (const bool reflects : {false, true}) {
      SCOPED_TRACE(mesh.name);
      const ReducedScene scene(mesh, true);
      std::vector<HandlePose> poses = scene.head_moved();
      if (reflects) poses.front() = test::pose_of(mirror);
      const ReducedField::Result found = scene.find(poses);
      EXPECT_EQ(found.linear, reflects);
      const std::vector<PoseMatrix> frames = scene.frames(poses);
      const auto rows = static_cast<Eigen::Index>(4 * scene.handles());
      for (std::size_t h = 0; h < frames.size(); ++h)
        EXPECT_EQ(PoseMatrix(found.coefficients.middleRows<4>((reflects ? rows : 0) +
                                                              static_cast<Eigen::Index>(4 * h))),
                  frames[h]);
      // Only one kind of blend takes part.
      EXPECT_TRUE(found.coefficients.middleRows(reflects ? 0 : rows, rows).isZero(0));
      if (reflects) {
        EXPECT_TRUE(found.coefficients.bottomRows(found.coefficients.rows() - 2 * rows).isZero(0));
        EXPECT_EQ(found.iterations, 0);
      }
    }
}

TEST(ReducedField, FindsTheSameAfterItsSetUpIsReleased) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    ReducedScene scene(mesh, false);
    scene.set_all_maps();
    const ReducedField::Result before = scene.find(scene.head_moved());
    scene.field.finish();
    const ReducedField::Result after = scene.find(scene.head_moved());
    EXPECT_GT(before.iterations, 1);
    EXPECT_EQ(before.coefficients, after.coefficients);
    EXPECT_EQ(before.change, after.change);
  }
}

TEST(ReducedField, StepsSettleOrEndAtTheLargestNumber) {
  for (const test::TestMesh& mesh : test::small_families()) {
    double first = 0;
    for (const int limit : {1, 40}) {
      SCOPED_TRACE(mesh.name + ", " + std::to_string(limit));
      ReducedScene scene(mesh, false, {.iterations = limit});
      scene.set_all_maps();
      const ReducedField::Result found = scene.find(scene.head_moved());
      EXPECT_GE(found.iterations, 1);
      EXPECT_LE(found.iterations, limit);
      if (limit == 1) first = found.change;
      EXPECT_LE(found.change, first);
      EXPECT_TRUE(limit == 1 || found.change < settled_change) << found.change;
    }
  }
}

}  // namespace
}  // namespace meshgraft
