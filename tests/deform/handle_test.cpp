#include <meshgraft/deform/deform_problem.h>

#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "mesh/shapes.h"

namespace meshgraft {
namespace {

constexpr double pi = std::numbers::pi;

Handle curve(std::vector<Index> vertices, bool closed = false) {
  Handle handle;
  handle.name = "curve";
  handle.shape = HandleShape::curve;
  handle.vertices = std::move(vertices);
  handle.closed = closed;
  return handle;
}

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

// Returns a strip whose lower row is wavy and unevenly spaced.
Mesh strip() {
  return shapes::sheet({.columns = 12, .rows = 2}, [](double u, double v) {
    return Eigen::Vector3d(3 * u * u + u, v, 0.4 * std::sin(5 * u));
  });
}

const std::vector<Index> lower_row = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};

TEST(RedrawCurve, KeepsAnUnchangedCurveToTheBit) {
  const Mesh mesh = strip();
  const Points rest = mesh.positions.topRows(13);
  EXPECT_EQ(redraw_curve(curve(lower_row), mesh.positions, rest), rest);
  const Mesh tube = shapes::tube(9, 2);
  const Points loop = tube.positions.topRows(9);
  const Handle closed = curve({0, 1, 2, 3, 4, 5, 6, 7, 8}, true);
  EXPECT_EQ(redraw_curve(closed, tube.positions, loop), loop);
  Points returning(10, 3);
  returning << loop, loop.row(0);
  EXPECT_EQ(redraw_curve(closed, tube.positions, returning), loop);
}

TEST(RedrawCurve, PlacesVerticesByRelativeArcLength) {
  const Mesh mesh = strip();
  Points corner(3, 3);
  corner << 0, 0, 0, 6, 0, 0, 6, 4, 0;  // length 10
  const Points redrawn = redraw_curve(curve(lower_row), mesh.positions, corner);
  ASSERT_EQ(redrawn.rows(), 13);
  EXPECT_EQ(redrawn.row(0), corner.row(0));
  EXPECT_EQ(redrawn.row(12), corner.row(2));
  double total = 0;
  for (int k = 1; k < 13; ++k) total += (mesh.positions.row(k) - mesh.positions.row(k - 1)).norm();
  double walked = 0;
  for (int k = 1; k < 13; ++k) {
    walked += (mesh.positions.row(k) - mesh.positions.row(k - 1)).norm();
    const double s = 10 * walked / total;
    const Eigen::RowVector3d expected = s < 6 ? Eigen::RowVector3d(s, 0, 0) : Eigen::RowVector3d(6, s - 6, 0);
    EXPECT_LT((redrawn.row(k) - expected).norm(), 1e-13);
  }
}

TEST(RedrawCurve, ClosesTheCourseOfAClosedCurve) {
  const Mesh tube = shapes::tube(8, 1);
  Points square(4, 3);
  square << 0, 0, 0, 2, 0, 0, 2, 2, 0, 0, 2, 0;
  const Points redrawn = redraw_curve(curve({0, 1, 2, 3, 4, 5, 6, 7}, true), tube.positions, square);
  Points expected(8, 3);
  expected << 0, 0, 0, 1, 0, 0, 2, 0, 0, 2, 1, 0, 2, 2, 0, 1, 2, 0, 0, 2, 0, 0, 1, 0;
  EXPECT_LT((redrawn - expected).cwiseAbs().maxCoeff(), 1e-13);
}

TEST(RedrawCurve, NamesWhatIsWrong) {
  const Mesh mesh = strip();
  const auto redraw = [&](const Handle& handle, const Points& polyline) {
    const Error error = error_of([&] { redraw_curve(handle, mesh.positions, polyline); });
    EXPECT_EQ(error.code(), ErrorCode::input);
    return std::string(error.id());
  };
  const Points line = mesh.positions.topRows(3);
  Handle region = curve({0, 1});
  region.shape = HandleShape::region;
  EXPECT_EQ(redraw(region, line), "deform.not_a_curve");
  EXPECT_EQ(redraw(curve({0}), line), "deform.curve_too_short");
  EXPECT_EQ(redraw(curve({0, 1}, true), line), "deform.curve_too_short");
  EXPECT_EQ(redraw(curve({0, 99}), line), "core.no_such_vertex");
  EXPECT_EQ(redraw(curve({0, 1}), line.topRows(1)), "deform.polyline_too_short");
  EXPECT_EQ(redraw(curve({0, 1}), Points::Ones(3, 3)), "deform.curve_without_length");
  EXPECT_EQ(redraw(curve({0, 1}), Points::Constant(2, 3, std::nan(""))), "core.not_finite");
}

TEST(CurveConstraints, AreTheIdentityForAnUnchangedCurve) {
  const Mesh mesh = strip();
  const Points normals = vertex_normals(mesh);
  const Handle handle = curve(lower_row);
  const Points redrawn = redraw_curve(handle, mesh.positions, mesh.positions.topRows(13));
  const auto constraints = curve_constraints(handle, {mesh.positions, normals}, redrawn);
  ASSERT_EQ(constraints.size(), 13);
  for (Index k = 0; k < 13; ++k) {
    EXPECT_EQ(constraints[k].vertex, k);
    EXPECT_EQ(*constraints[k].position, Eigen::Vector3d(mesh.positions.row(k)));
    EXPECT_EQ(*constraints[k].transform, Eigen::Matrix3d(Eigen::Matrix3d::Identity()));
  }
}

TEST(CurveConstraints, AreThePlaneRotationOfAPlaneCurve) {
  // The curve is turned and scaled within its plane, so the smallest rotation is that turn.
  const Mesh mesh = shapes::grid(5, 1);
  const Handle handle = curve({0, 1, 2, 3, 4, 5});
  const Eigen::Matrix3d w = 1.7 * Eigen::AngleAxisd(2.5, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  const Points redrawn = mesh.positions.topRows(6) * w.transpose();
  for (const auto& constraint : curve_constraints(handle, {mesh.positions, vertex_normals(mesh)}, redrawn)) {
    EXPECT_LT((*constraint.transform - w).norm(), 1e-13);
  }
}

TEST(CurveConstraints, TakeTangentsToTangentsScaledByArcLength) {
  const Mesh tube = shapes::tube(24, 3);
  std::vector<Index> loop(24);
  for (Index k = 0; k < 24; ++k) loop[k] = 24 + k;
  const Handle handle = curve(loop, true);
  Points redrawn(24, 3);
  for (int k = 0; k < 24; ++k) {
    const double a = 2 * pi * k / 24;
    redrawn.row(k) << 3 * std::cos(a), 1.2 * std::sin(a), 1 + 0.5 * std::sin(2 * a);
  }
  const auto constraints = curve_constraints(handle, {tube.positions, vertex_normals(tube)}, redrawn);
  for (int k = 0; k < 24; ++k) {
    const auto tangent = [&](const auto& point) -> Eigen::Vector3d {
      return (point((k + 1) % 24) - point((k + 23) % 24)).transpose().normalized();
    };
    const auto length = [&](const auto& point) {
      return (point((k + 1) % 24) - point(k)).norm() + (point(k) - point((k + 23) % 24)).norm();
    };
    const auto old_point = [&](int j) -> Eigen::RowVector3d { return tube.positions.row(24 + j); };
    const auto new_point = [&](int j) -> Eigen::RowVector3d { return redrawn.row(j); };
    const Eigen::Matrix3d w = *constraints[k].transform;
    const double ratio = length(new_point) / length(old_point);
    EXPECT_LT((w * tangent(old_point) - ratio * tangent(new_point)).norm(), 1e-13);
    EXPECT_LT((w * w.transpose() - ratio * ratio * Eigen::Matrix3d::Identity()).norm(), 1e-12);
    EXPECT_GT(w.determinant(), 0);
    // No part of the rotation is about the tangent, so its axis is orthogonal to both tangents.
    const Eigen::Vector3d axis = Eigen::AngleAxisd(Eigen::Matrix3d(w / ratio)).axis();
    EXPECT_NEAR(axis.dot(tangent(old_point)), 0, 1e-7);
  }
}

TEST(CurveConstraints, TurnAboutTheNormalWhereTheTangentTurnsRound) {
  const Mesh mesh = shapes::grid(3, 1);
  const Handle handle = curve({0, 1, 2, 3});
  const Points reversed = mesh.positions.topRows(4).colwise().reverse();
  Eigen::Matrix3d half_turn = Eigen::Vector3d(-1, -1, 1).asDiagonal();
  for (const auto& constraint : curve_constraints(handle, {mesh.positions, vertex_normals(mesh)}, reversed)) {
    EXPECT_LT((*constraint.transform - half_turn).norm(), 1e-15);
  }
}

TEST(CurveConstraints, RespectWhatTheHandleConstrains) {
  const Mesh mesh = shapes::grid(3, 1);
  Handle handle = curve({0, 1, 2, 3});
  handle.constrain_position = false;
  const Points normals = vertex_normals(mesh);
  for (const auto& c : curve_constraints(handle, {mesh.positions, normals}, mesh.positions.topRows(4))) {
    EXPECT_FALSE(c.position.has_value());
    EXPECT_TRUE(c.transform.has_value());
  }
  handle.constrain_position = true;
  handle.constrain_transform = false;
  for (const auto& c : curve_constraints(handle, {mesh.positions, normals}, mesh.positions.topRows(4))) {
    EXPECT_TRUE(c.position.has_value());
    EXPECT_FALSE(c.transform.has_value());
  }
}

TEST(CurveConstraints, NameWhatIsWrong) {
  const Mesh mesh = shapes::grid(3, 1);
  const Handle handle = curve({0, 1, 2, 3});
  const Points normals = vertex_normals(mesh);
  Points folded = mesh.positions.topRows(4);
  folded.row(1) = folded.row(0);
  const Error error = error_of([&] { curve_constraints(handle, {mesh.positions, normals}, folded); });
  EXPECT_EQ(error.code(), ErrorCode::input);
  EXPECT_EQ(error.id(), "deform.curve_without_tangent");
  EXPECT_EQ(error.fact().get<std::int64_t>("point"), 0);
  EXPECT_EQ(error.fact().get<std::int64_t>("vertex"), 0);
  const auto short_of = [&](const Points& rest_normals, const Points& redrawn) {
    const Error short_call =
        error_of([&] { curve_constraints(handle, {mesh.positions, rest_normals}, redrawn); });
    EXPECT_EQ(short_call.code(), ErrorCode::usage);
    EXPECT_EQ(short_call.id(), "core.size_mismatch");
    return short_call.fact().get<std::string>("what");
  };
  EXPECT_EQ(short_of(normals, Points::Zero(3, 3)), "redrawn_points");
  EXPECT_EQ(short_of(Points::Zero(3, 3), mesh.positions.topRows(4)), "rest_normals");
}

}  // namespace
}  // namespace meshgraft
