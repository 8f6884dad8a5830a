#include <meshgraft/deform/deform_problem.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <utility>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "mesh/shapes.h"

namespace meshgraft {
namespace {

constexpr double pi = std::numbers::pi;

template <typename Call>
Error error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error;
  }
  throw std::logic_error("no error");
}

TEST(HandlePivot, IsTheCentreOfTheRim) {
  const Mesh grid = shapes::grid(6, 6);
  const IndexLists rings = vertex_rings(grid.vertex_count(), grid.faces);
  Handle handle;
  handle.vertices = {0, 1, 2, 7, 8, 9, 14, 15, 16};  // a corner block: its rim is its inner row and column
  const Eigen::Vector3d expected = Eigen::Vector3d(2 + 2 + 2 + 1 + 0, 0 + 1 + 2 + 2 + 2, 0) / 5;
  EXPECT_LT((handle_pivot(handle, grid.positions, rings) - expected).norm(), 1e-15);
}

TEST(HandlePivot, IsTheMeanWhereThereIsNoRim) {
  const Mesh cube = shapes::cube();
  const IndexLists rings = vertex_rings(8, cube.faces);
  Handle handle;
  handle.vertices = {0, 1, 2, 3, 4, 5, 6, 7};
  EXPECT_EQ(handle_pivot(handle, cube.positions, rings), Eigen::Vector3d::Constant(0.5));
}

TEST(HandlePivot, NamesAnEmptyHandleAndABadIndex) {
  const Mesh cube = shapes::cube();
  const IndexLists rings = vertex_rings(8, cube.faces);
  Handle handle;
  handle.name = "ear";
  const Error empty = error_of([&] { handle_pivot(handle, cube.positions, rings); });
  EXPECT_EQ(empty.id(), "deform.no_vertices");
  EXPECT_EQ(empty.location().text(), "handle 'ear'");
  handle.vertices = {8};
  EXPECT_EQ(error_of([&] { handle_pivot(handle, cube.positions, rings); }).code(), ErrorCode::input);
}

TEST(MakePose, IsScaleThenTurnAboutThePivotThenShift) {
  HandleMotion motion;
  motion.translate = {1, 2, 3};
  motion.axis = {1, -1, 2};
  motion.angle_deg = 77;
  motion.scale = {2, 0.5, -1};
  motion.pivot = Eigen::Vector3d(4, 5, 6);
  const HandlePose pose = make_pose(motion, {9, 9, 9});
  const Eigen::AngleAxisd turn(77 * pi / 180, motion.axis.normalized());
  for (const Eigen::Vector3d& x :
       {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(4, 5, 6), Eigen::Vector3d(-1, 7, 2)}) {
    const Eigen::Vector3d expected =
        *motion.pivot + motion.translate + turn * (motion.scale.asDiagonal() * (x - *motion.pivot));
    EXPECT_LT((pose.transform * x - expected).norm(), 1e-13);
  }
}

TEST(MakePose, LeavesThePivotInPlace) {
  HandleMotion motion;
  motion.angle_deg = 33;
  motion.scale = {3, 2, 1};
  const Eigen::Vector3d pivot(10, -4, 2);
  EXPECT_LT((make_pose(motion, pivot).transform * pivot - pivot).norm(), 1e-14);
}

TEST(MakePose, KeepsTurnsUnreduced) {
  HandleMotion motion;
  motion.axis = {0, 0, 5};
  for (const double angle : {-720.0, -270.0, 30.0, 270.0, 720.0, 3690.0}) {
    motion.angle_deg = angle;
    const HandlePose pose = make_pose(motion, Eigen::Vector3d::Zero());
    ASSERT_TRUE(pose.rotation.has_value());
    EXPECT_DOUBLE_EQ(pose.rotation->angle(), angle * pi / 180);
    EXPECT_EQ(pose.rotation->axis(), Eigen::Vector3d::UnitZ());
    EXPECT_LT((pose.transform.linear() - pose.rotation->toRotationMatrix()).norm(), 1e-12);
  }
}

TEST(MakePose, IsExactWhereItCanBe) {
  const Eigen::Vector3d far(1e9 + 0.3, -2e9, 7e8);
  HandleMotion motion;
  EXPECT_TRUE(make_pose(motion, far).transform.matrix() == Eigen::Matrix4d::Identity());
  motion.angle_deg = 360 * 7;
  EXPECT_TRUE(make_pose(motion, far).transform.matrix() == Eigen::Matrix4d::Identity());
  motion.translate = {0.1, 0.2, 0.3};
  EXPECT_EQ(make_pose(motion, far).transform.translation(), motion.translate);
  motion.angle_deg = 90;
  Eigen::Matrix3d quarter;
  quarter << 0, -1, 0, 1, 0, 0, 0, 0, 1;
  EXPECT_EQ(make_pose(motion, far).transform.linear(), quarter);
}

TEST(MakePose, RefusesNumbersThatAreTooLarge) {
  HandleMotion turned;
  turned.angle_deg = -1e6;
  EXPECT_NO_THROW(make_pose(turned, Eigen::Vector3d::Zero()));
  turned.angle_deg = -1e18;
  HandleMotion shifted;
  shifted.translate.y() = 1e200;
  for (const auto& [motion, field] : {std::pair{turned, "angle_deg"}, std::pair{shifted, "translate"}}) {
    const Error error = error_of([&] { make_pose(motion, Eigen::Vector3d::Zero()); });
    EXPECT_EQ(error.id(), "core.out_of_range");
    EXPECT_EQ(error.location().text(), field);
  }
}

TEST(MakePose, NamesWhatIsWrong) {
  HandleMotion motion;
  motion.axis = Eigen::Vector3d::Zero();
  EXPECT_NO_THROW(make_pose(motion, Eigen::Vector3d::Zero()));
  motion.angle_deg = 10;
  const Error no_axis = error_of([&] { make_pose(motion, Eigen::Vector3d::Zero()); });
  EXPECT_EQ(no_axis.id(), "deform.axis_without_length");
  EXPECT_EQ(no_axis.location().text(), "axis");
  motion = {};
  motion.scale.x() = std::nan("");
  EXPECT_EQ(error_of([&] { make_pose(motion, Eigen::Vector3d::Zero()); }).location().text(), "scale");
  motion = {};
  motion.angle_deg = INFINITY;
  const Error no_angle = error_of([&] { make_pose(motion, Eigen::Vector3d::Zero()); });
  EXPECT_EQ(no_angle.code(), ErrorCode::input);
  EXPECT_EQ(no_angle.id(), "core.not_finite");
}

}  // namespace
}  // namespace meshgraft
