#include "deform/solve/pose_matrix.h"

#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

TEST(PoseMatrix, DisplacesAsThePoseDoes) {
  for (const test::TestMesh& mesh : test::small_families())
    for (const auto& [name, linear] : test::linear_maps()) {
      const Eigen::Affine3d map = test::about_middle(mesh, linear);
      for (const double scale : {0.25, 1.0, 64.0}) {
        const Eigen::RowVector3d centre = mesh.positions.colwise().mean();
        const PoseMatrix frame = pose_matrix(test::pose_of(map), centre, scale);
        for (Index v = 0; v < mesh.size(); ++v) {
          const Eigen::RowVector3d p = mesh.positions.row(v), local = (p - centre) / scale;
          const Eigen::RowVector3d moved = (map * Eigen::Vector3d(p.transpose())).transpose();
          const Eigen::RowVector3d displacement = local * frame.topRows<3>() + frame.row(3);
          EXPECT_LT((scale * displacement - (moved - p)).norm(), 1e-12 * (1 + p.norm() + moved.norm()))
              << mesh.name << ", " << name;
        }
      }
    }
}

TEST(PoseMatrix, IsExactlyZeroAtRest) { EXPECT_TRUE(pose_matrix({}, {1e9, -3, 0.1}, 4).isZero(0)); }

TEST(PoseMatrix, IsLinearInTheChangeOfThePose) {
  Eigen::Affine3d one = Eigen::Affine3d::Identity(), other = one, sum = one;
  one.linear() << 1, 0.5, 0, -0.25, 2, 0, 0, 1, 1;
  one.translation() << 1, 2, 3;
  other.linear() << 3, 0, 1, 0, 0.5, 0, 0.5, 0, 1;
  other.translation() << -4, 0, 0.5;
  sum.matrix() = one.matrix() + other.matrix() - Eigen::Matrix4d::Identity();
  const Eigen::RowVector3d centre(1, -2, 0.5);
  EXPECT_EQ(pose_matrix(test::pose_of(sum), centre, 2),
            pose_matrix(test::pose_of(one), centre, 2) + pose_matrix(test::pose_of(other), centre, 2));
}

TEST(PoseMatrix, NumbersThatAreNotFiniteAreRefused) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity(), -1e101}) {
    HandlePose by_map, by_rotation, by_curve;
    by_map.transform.translation()[1] = bad;
    EXPECT_THROW(validate(by_map, "handle 'a'"), Error);
    by_curve.curve = Points::Constant(2, 3, bad);
    EXPECT_THROW(validate(by_curve, "handle 'a'"), Error);
    if (std::isfinite(bad)) continue;
    by_rotation.rotation = Eigen::AngleAxisd(bad, Eigen::Vector3d::UnitX());
    EXPECT_THROW(validate(by_rotation, "handle 'a'"), Error);
  }
  EXPECT_NO_THROW(validate(HandlePose{}, "handle 'a'"));
}

TEST(PoseMatrix, OnlyAffinePosesHaveOne) {
  const std::vector<Handle> handles{{.name = "a"}, {.name = "b"}};
  std::vector<HandlePose> poses(2);
  EXPECT_NO_THROW(require_affine_poses(handles, poses));
  EXPECT_THROW(require_affine_poses(handles, std::span(poses).first(1)), Error);
  poses[1].curve = Points::Zero(2, 3);
  try {
    require_affine_poses(handles, poses);
    ADD_FAILURE() << "nothing was thrown";
  } catch (const Error& error) {
    EXPECT_EQ(error.id(), "deform.curve_not_affine");
    EXPECT_NE(error.location().text().find('b'), std::string::npos) << error.location().text();
  }
}

}  // namespace
}  // namespace meshgraft
