// Large turns and bends come out smooth and stable, and better than by the linear method.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>

#include "rotating_methods.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

/// From 0° to 720° no frame jumps, and a handle's whole turns change the result.
TEST(Methods, TurnsAreContinuousAndUnreduced) {
  constexpr double step_deg = 8;
  for (const TestMesh& mesh : {bar(3, 20), irregular_grid(30, 8)}) {
    const Scene scene = make_scene(mesh);
    Eigen::Vector3d extent =
        (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).transpose();
    Vector3d along = Vector3d::Zero();
    Eigen::Index longest = 0;
    extent.maxCoeff(&longest);
    along[longest] = 1;
    for (const DeformerOptions& options : method_variants()) {
      if (options.method == DeformMethod::shell) continue;  // a shell may buckle
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Deformer deformer = make_deformer(scene, held_foot(scene), options);
      Points previous = deformer.evaluate(std::vector{turned(scene, 0, along)});
      EXPECT_TRUE(same_bytes(previous, mesh.positions));
      double largest = 0, travelled = 0;
      for (double angle = step_deg; angle <= 720; angle += step_deg) {
        const Points next = deformer.evaluate(std::vector{turned(scene, angle, along)});
        // No vertex may move much farther in a frame than those of the turned handle.
        largest = std::max(largest, relative_distance(mesh, next, previous));
        travelled = std::max(travelled, relative_distance(mesh, next, mesh.positions));
        previous = next;
      }
      const double radius = 0.5 * (extent - along.cwiseProduct(extent)).norm() / mesh.box_diagonal();
      EXPECT_LT(largest, 3 * radius * step_deg * std::numbers::pi / 180 + 0.005);
      const Points once = deformer.evaluate(std::vector{turned(scene, 360, along)});
      EXPECT_GT(relative_distance(mesh, previous, once), 0.1 * radius);
      EXPECT_GT(relative_distance(mesh, once, mesh.positions), 0.1 * radius);
    }
  }
}

/// Steps may oscillate in a bend, so a tiny change of the angle must change little.
TEST(Methods, BendsDoNotJump) {
  const Scene scene = make_scene(tube(12, 18));
  const auto bend = [](double angle_deg) {
    HandleMotion motion;
    motion.axis = Vector3d::UnitX();
    motion.angle_deg = angle_deg;
    return std::vector{make_pose(motion, Vector3d(0, 0, 2))};
  };
  const Deformer deformer = make_deformer(scene, held_foot(scene), {});
  for (double angle = 90; angle < 300; angle += 7) {
    const double jump =
        relative_distance(scene.mesh, deformer.evaluate(bend(angle + 1e-4)), deformer.evaluate(bend(angle)));
    EXPECT_LT(jump, 0.01) << angle;
  }
}

/// Checks the methods' main advantage: a bar twisted by 135° keeps its thickness better than by the linear one.
TEST(Methods, LargeTurnsDoNotShrink) {
  const Scene scene = make_scene(bar(6, 36));
  const HandlePose twist = turned(scene, 135, Vector3d::UnitZ());
  const auto quality_of = [&](const DeformerOptions& options) {
    const Deformer deformer = make_deformer(scene, held_foot(scene), options);
    return measure_quality({scene.mesh.positions, deformer.evaluate(std::vector{twist}), scene.mesh.triangles,
                            deformer.free_vertices()});
  };
  const Quality linear = quality_of(linear_method());
  for (const DeformerOptions& options : method_variants()) {
    const Quality quality = quality_of(options);
    EXPECT_LT(quality.edge_rms, 0.6 * linear.edge_rms) << describe(options);
    EXPECT_GT(quality.sigma_min, 1.4 * linear.sigma_min) << describe(options);
    EXPECT_LT(1 - *quality.volume_ratio, 0.6 * (1 - *linear.volume_ratio)) << describe(options);
  }
}

TEST(Methods, ScalesSpreadWithTheRotations) {
  const Scene scene = make_scene(tube(20, 60));
  HandleMotion motion;
  motion.scale = Vector3d::Constant(2);
  motion.axis = Vector3d::UnitZ();
  motion.angle_deg = 90;
  const Vector3d middle(0, 0, scene.mesh.positions.row(scene.head.front())[2]);
  const std::vector poses{make_pose(motion, middle)};
  for (const DeformerOptions& options : method_variants()) {
    const Points result = make_deformer(scene, held_foot(scene), options).evaluate(poses);
    // Halfway up, the tube is wider than at its foot and narrower than at its head.
    double sum = 0;
    int count = 0;
    const double low = scene.mesh.positions.col(2).minCoeff(), high = scene.mesh.positions.col(2).maxCoeff();
    for (Index v = 0; v < scene.mesh.size(); ++v) {
      const double place = (scene.mesh.positions(v, 2) - low) / (high - low);
      if (std::abs(place - 0.55) > 0.03) continue;
      sum += result.row(v).head<2>().norm() / scene.mesh.positions.row(v).head<2>().norm();
      ++count;
    }
    ASSERT_GT(count, 0);
    EXPECT_GT(sum / count, 1.15) << describe(options);
    EXPECT_LT(sum / count, 1.85) << describe(options);
  }
}

/// Checks that the result converges and stays stable over many more steps than the default.
TEST(Methods, ManyStepsAreStable) {
  for (const TestMesh& mesh :
       {bumpy_sphere(3), bar(4, 30), tube(16, 40), irregular_grid(30, 24), torus(14, 30)}) {
    const Scene scene = make_scene(mesh);
    for (const double stiffness : {0.0, DeformerOptions{}.stiffness, 1000.0})
      for (const double angle : {60.0, 150.0}) {
        SCOPED_TRACE(mesh.name + ", stiffness " + std::to_string(stiffness) + ", " + std::to_string(angle));
        DeformerOptions options = options_of(DeformMethod::corotational, stiffness);
        const auto result_after = [&](int iterations, EvaluationReport& report) {
          options.iterations = iterations;
          return make_deformer(scene, held_foot(scene), options)
              .evaluate(std::vector{turned(scene, angle)}, {}, &report);
        };
        EvaluationReport thirty, sixty;
        const Points at_thirty = result_after(30, thirty), at_sixty = result_after(60, sixty);
        EXPECT_LE(thirty.iterations, 30);
        EXPECT_LT(thirty.last_rotation_change, 0.05);
        EXPECT_LT(relative_distance(mesh, at_sixty, at_thirty), 0.05);
      }
  }
}

}  // namespace
}  // namespace meshgraft::test
