#include <meshgraft/deform/deform_problem.h>

#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

#include <gtest/gtest.h>
#include <Eigen/SVD>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
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

TEST(CurveConstraints, AreThePlaneRotationOfAStraightCurve) {
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

// A curve with a surface beside it.
struct RuledCurve {
  std::string name;
  Mesh mesh;  // its first vertices are the curve
  Handle handle;
  double width = 0;  // second singular value over the first

  Points points() const { return mesh.positions.topRows(static_cast<Eigen::Index>(handle.vertices.size())); }
  Points normals() const { return vertex_normals(mesh); }
};

RuledCurve ruled(const std::string& name, bool closed, const std::function<Eigen::Vector3d(double)>& place) {
  constexpr int columns = 40;
  RuledCurve curve_with_surface{.name = name};
  curve_with_surface.mesh = shapes::sheet(
      {.columns = columns, .rows = 3, .close_columns = closed},
      [&](double u, double v) -> Eigen::Vector3d { return place(u) + v * Eigen::Vector3d(0.02, 0.3, 1); });
  std::vector<Index> vertices(closed ? columns : columns + 1);
  for (std::size_t k = 0; k < vertices.size(); ++k) vertices[k] = static_cast<Index>(k);
  curve_with_surface.handle = curve(vertices, closed);
  const Points points = curve_with_surface.points();
  const Points centred = points.rowwise() - points.colwise().mean();
  const Eigen::Vector3d sizes = Eigen::JacobiSVD<Eigen::MatrixXd>(centred).singularValues();
  curve_with_surface.width = sizes[1] / sizes[0];
  return curve_with_surface;
}

// An arc whose width is about `sagitta` of its length.
RuledCurve arc(double sagitta) {
  return ruled("arc of width " + std::to_string(sagitta), false,
               [sagitta](double u) { return Eigen::Vector3d(u, 13.4 * sagitta * u * (1 - u), 0); });
}

std::vector<RuledCurve> wide_curves() {
  return {
      ruled("circle", true,
            [](double u) { return Eigen::Vector3d(std::cos(2 * pi * u), std::sin(2 * pi * u), 0); }),
      ruled("ellipse far from the origin", true,
            [](double u) {
              return Eigen::Vector3d(1000 + 3 * std::cos(2 * pi * u), std::sin(2 * pi * u), -500);
            }),
      ruled("saddle rim", true,
            [](double u) {
              return Eigen::Vector3d(std::cos(2 * pi * u), std::sin(2 * pi * u), 0.4 * std::cos(4 * pi * u));
            }),
      ruled("helix", false, [](double u) { return Eigen::Vector3d(std::cos(9 * u), std::sin(9 * u), 2 * u); }),
      ruled("unevenly sampled wave", false,
            [](double u) { return Eigen::Vector3d(3 * u * u + u, 0, 0.4 * std::sin(5 * u)); }),
      arc(0.1),
      arc(0.0013)};
}

Points redrawn_as(const Eigen::Affine3d& map, const Points& points) {
  return (points * map.linear().transpose()).rowwise() + map.translation().transpose();
}

Eigen::Affine3d similarity(double scale, double angle, const Eigen::Vector3d& axis) {
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = scale * Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  map.translation() = Eigen::Vector3d(0.3, -2, 1);
  return map;
}

TEST(CurveConstraints, OfASimilarCopyAreTheMapOfTheCopy) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (const RuledCurve& sample : wide_curves()) {
    SCOPED_TRACE(sample.name);
    ASSERT_GT(sample.width, 1e-3);
    for (int trial = 0; trial < 20; ++trial) {
      const Eigen::Affine3d map =
          similarity(std::exp(unit(random)), pi * unit(random), {unit(random), unit(random), unit(random)});
      const Points redrawn = redrawn_as(map, sample.points());
      const Points normals = sample.normals();
      for (const auto& constraint : curve_constraints(sample.handle, {sample.mesh.positions, normals}, redrawn))
        ASSERT_LT((*constraint.transform - map.linear()).norm(), 1e-9 * map.linear().norm());
    }
  }
}

TEST(CurveConstraints, OfAStraightCurveTurnAsLittleAsTheyCan) {
  const RuledCurve line = arc(0);
  for (const double angle : {0.3, 1.5, 3.0}) {
    const Eigen::Vector3d axis = Eigen::Vector3d(0, 1, 2).normalized();  // orthogonal to the line
    const Eigen::Matrix3d spin = Eigen::AngleAxisd(1, Eigen::Vector3d::UnitX()).toRotationMatrix();
    Eigen::Affine3d map = similarity(2, angle, axis);
    const Eigen::Matrix3d least = map.linear();
    map.linear() = map.linear() * spin;  // leaves the line where it is
    const Points normals = line.normals();
    for (const auto& constraint :
         curve_constraints(line.handle, {line.mesh.positions, normals}, redrawn_as(map, line.points())))
      EXPECT_LT((*constraint.transform - least).norm(), 1e-9);
  }
}

// Returns the largest change of a local transform between the poses of consecutive steps.
double largest_step(const std::function<std::vector<VertexConstraint>(double)>& pose_at, int steps) {
  double largest = 0;
  std::vector<VertexConstraint> last = pose_at(0);
  for (int step = 1; step <= steps; ++step) {
    const std::vector<VertexConstraint> next = pose_at(static_cast<double>(step) / steps);
    for (std::size_t k = 0; k < next.size(); ++k)
      largest = std::max(largest, (*next[k].transform - *last[k].transform).norm());
    last = next;
  }
  return largest;
}

TEST(CurveConstraints, AreContinuousInTheWidthOfTheCurve) {
  const Eigen::Affine3d map = similarity(1, 2, {1, 2, 3});  // turns the curve about itself, too
  const auto pose_at = [&](double share) {
    const RuledCurve sample = arc(2e-3 * share);
    const Points normals = sample.normals();
    return curve_constraints(sample.handle, {sample.mesh.positions, normals}, redrawn_as(map, sample.points()));
  };
  const double step = largest_step(pose_at, 2000);
  EXPECT_LT(step, 0.02);
  EXPECT_LT(largest_step(pose_at, 4000), 0.6 * step);
}

TEST(CurveConstraints, AreContinuousInTheMotion) {
  // The copy turns by almost half a turn while it is bent, so that tangents turn by up to 2 radians beyond it.
  // A narrow curve turns by less: turned about itself by half a turn and bent out of shape, it has no nearest
  // turn.
  for (const RuledCurve& sample : wide_curves()) {
    SCOPED_TRACE(sample.name);
    const Points points = sample.points(), normals = sample.normals();
    const Eigen::RowVector3d middle = points.colwise().mean();
    const double size = (points.rowwise() - middle).rowwise().norm().maxCoeff();
    const auto pose_at = [&](double share) {
      const double angle = sample.width > 0.2 ? 3 : 2;
      Points redrawn = redrawn_as(similarity(1 + share, angle * share, {1, 2, 3}), points);
      for (Eigen::Index k = 0; k < redrawn.rows(); ++k) {
        const double phase = 4 * pi * static_cast<double>(k) / static_cast<double>(redrawn.rows());
        redrawn.row(k) += 0.3 * share * size * Eigen::RowVector3d(std::sin(phase), 0, std::cos(phase));
      }
      return curve_constraints(sample.handle, {sample.mesh.positions, normals}, redrawn);
    };
    EXPECT_LT(largest_step(pose_at, 400), 0.2);
  }
}

TEST(CurveConstraints, TurnWithTheTangentsWhereTheNewCourseIsNoCopy) {
  // Over a line with a dip, an arch fits best upside down, and over a wave sideways.
  for (const double dip : {0.0, 0.01, 0.03, 0.06})
    for (const double wave : {0.0, 0.01, 0.02}) {
      SCOPED_TRACE(std::to_string(dip) + ", " + std::to_string(wave));
      const RuledCurve line = ruled("line", false, [&](double u) {
        return Eigen::Vector3d(u, wave * std::sin(12 * u + 1), -dip * std::sin(pi * u));
      });
      Points arch = line.points();
      for (Eigen::Index k = 0; k < arch.rows(); ++k)
        arch.row(k) << arch(k, 0), 0, 0.3 * std::sin(pi * arch(k, 0));
      const Points normals = line.normals();
      const auto constraints = curve_constraints(line.handle, {line.mesh.positions, normals}, arch);
      const Eigen::Matrix3d middle = *constraints[constraints.size() / 2].transform;
      EXPECT_LT((middle.col(2).normalized() - Eigen::Vector3d::UnitZ()).norm(), 0.25);
    }
  // An arch of about the height of the dip is its mirror image, and a higher one is not.
  const RuledCurve valley =
      ruled("valley", false, [](double u) { return Eigen::Vector3d(u, 0, -0.04 * std::sin(pi * u)); });
  const auto arch_of = [&](double height) {
    Points arch = valley.points();
    for (Eigen::Index k = 0; k < arch.rows(); ++k) arch(k, 2) = height * std::sin(pi * arch(k, 0));
    return arch;
  };
  const Points valley_normals = valley.normals();
  EXPECT_TRUE(is_mirror_image(valley.handle, {valley.mesh.positions, valley_normals}, arch_of(0.04)));
  for (const double height : {0.01, 0.09, 0.2})
    EXPECT_FALSE(is_mirror_image(valley.handle, {valley.mesh.positions, valley_normals}, arch_of(height)))
        << height;
  // A hand never draws an exact copy; what it turns by is still seen.
  const RuledCurve bow = arc(0.1);
  for (const double angle : {0.5, 1.5, 2.5}) {
    const Eigen::Affine3d map = similarity(1, angle, {1, 0, 0});
    Points redrawn = redrawn_as(map, bow.points());
    for (Eigen::Index k = 0; k < redrawn.rows(); ++k)
      redrawn.row(k) += 0.002 * Eigen::RowVector3d(0, std::sin(0.9 * static_cast<double>(k)),
                                                   std::cos(0.7 * static_cast<double>(k)));
    const Points normals = bow.normals();
    Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
    for (const auto& constraint : curve_constraints(bow.handle, {bow.mesh.positions, normals}, redrawn))
      sum += *constraint.transform;
    const double turned = std::atan2(sum(2, 1) - sum(1, 2), sum(1, 1) + sum(2, 2));
    EXPECT_NEAR(turned, angle, 0.15);
  }
}

TEST(CurveConstraints, TakeAMirrorImageInThePlaneForHalfATurn) {
  const RuledCurve circle = wide_curves()[0];
  RuledCurve arch = arc(0.1);
  for (const RuledCurve& sample : {circle, arch}) {
    SCOPED_TRACE(sample.name);
    Points mirrored = sample.points();
    mirrored.col(1) *= -1;
    const Points normals = sample.normals();
    EXPECT_TRUE(is_mirror_image(sample.handle, {sample.mesh.positions, normals}, mirrored));
    const Eigen::Matrix3d half_turn = Eigen::Vector3d(1, -1, -1).asDiagonal();
    for (const auto& constraint : curve_constraints(sample.handle, {sample.mesh.positions, normals}, mirrored))
      EXPECT_LT((*constraint.transform - half_turn).norm(), 1e-9);
  }
  // Another stroke is no mirror image, wherever it runs.
  Points stroke = arch.points();
  for (Eigen::Index k = 0; k < stroke.rows(); ++k) stroke(k, 1) *= -std::sin(static_cast<double>(k) / 4);
  const Points arch_normals = arch.normals();
  EXPECT_FALSE(is_mirror_image(arch.handle, {arch.mesh.positions, arch_normals}, stroke));
  for (const RuledCurve& sample : wide_curves()) {
    const Points normals = sample.normals();
    const RestSurface rest{sample.mesh.positions, normals};
    EXPECT_FALSE(is_mirror_image(sample.handle, rest, sample.points())) << sample.name;
    const Eigen::Affine3d turn = similarity(2, 2.5, {1, 0, 0});
    EXPECT_FALSE(is_mirror_image(sample.handle, rest, redrawn_as(turn, sample.points()))) << sample.name;
  }
}

// A bow on the edge of a sheet, flat or slightly domed: its mouth line.
struct MouthLine {
  double sag = 0.2, curvature = 0;
  Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();

  Eigen::Vector3d point(double u, double sag_there, double v = 0) const {
    const double x = u - 0.5, y = sag_there * std::sin(pi * u) + v;
    return axes * Eigen::Vector3d(x, y, -0.5 * curvature * (x * x + y * y));
  }
  Eigen::Vector3d normal_at(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d local = axes.transpose() * point;
    return (axes * Eigen::Vector3d(curvature * local.x(), curvature * local.y(), 1)).normalized();
  }
  RuledCurve at_rest() const {
    constexpr int columns = 40;
    RuledCurve line{.name = "sag " + std::to_string(sag) + ", curvature " + std::to_string(curvature)};
    line.mesh = shapes::sheet({.columns = columns, .rows = 8},
                              [&](double u, double v) { return point(u, sag, 0.6 * v); });
    std::vector<Index> vertices(columns + 1);
    for (Index k = 0; k <= columns; ++k) vertices[k] = k;
    line.handle = curve(vertices);
    return line;
  }
  Points redrawn(double amplitude) const {
    Points points(41, 3);
    for (Eigen::Index k = 0; k <= 40; ++k)
      points.row(k) = point(static_cast<double>(k) / 40, amplitude * sag).transpose();
    return points;
  }
};

std::vector<MouthLine> mouth_lines() {
  const Eigen::Matrix3d any = Eigen::AngleAxisd(2, Eigen::Vector3d(1, -2, 0.5).normalized()).toRotationMatrix();
  return {{0.02}, {0.1}, {0.2}, {0.4}, {0.2, 0, any}, {0.2, 0.1}, {0.2, 0.2}, {0.4, 0.2, any}};
}

TEST(CurveConstraints, StayInASurfaceWithinWhichTheCurveIsRedrawn) {
  for (const MouthLine& mouth : mouth_lines()) {
    const RuledCurve line = mouth.at_rest();
    const Points normals = line.normals();
    const RestSurface rest{line.mesh.positions, normals};
    for (int step = -40; step <= 40; ++step) {
      SCOPED_TRACE(line.name + ", " + std::to_string(step) + "/20");
      const Points redrawn = mouth.redrawn(step / 20.0);
      EXPECT_FALSE(is_mirror_image(line.handle, rest, redrawn));
      for (const auto& constraint : curve_constraints(line.handle, rest, redrawn)) {
        const Eigen::Vector3d normal = *constraint.transform * normals.row(constraint.vertex).transpose();
        const Eigen::Vector3d expected = mouth.normal_at(*constraint.position);
        ASSERT_LT((normal.normalized() - expected).norm(), mouth.curvature == 0 ? 1e-9 : 0.35);
      }
    }
  }
}

// A hand does not draw exactly within the surface.
TEST(CurveConstraints, StayInASurfaceInSpiteOfATremor) {
  for (const double sag : {0.1, 0.2, 0.4}) {
    const MouthLine mouth{sag};
    const RuledCurve line = mouth.at_rest();
    const Points normals = line.normals();
    for (int step = -40; step <= 40; ++step) {
      SCOPED_TRACE(line.name + ", " + std::to_string(step) + "/20");
      Points redrawn = mouth.redrawn(step / 20.0);
      for (Eigen::Index k = 0; k < redrawn.rows(); ++k)
        redrawn.row(k) += 0.005 * Eigen::RowVector3d(0, std::sin(0.9 * static_cast<double>(k)),
                                                     std::cos(0.7 * static_cast<double>(k)));
      Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
      for (const auto& constraint : curve_constraints(line.handle, {line.mesh.positions, normals}, redrawn))
        sum += *constraint.transform;
      EXPECT_GT(sum.col(2).normalized().z(), 0.999);
    }
  }
}

TEST(CurveConstraints, OfACopyThatLeavesTheSurfaceAreTheMapOfTheCopy) {
  for (const MouthLine& mouth : mouth_lines()) {
    const RuledCurve line = mouth.at_rest();
    SCOPED_TRACE(line.name);
    const Points normals = line.normals();
    for (const Eigen::Vector3d& axis :
         {Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0, 1, 0), Eigen::Vector3d(0, 0, 1)})
      for (const double angle : {-3.1, -1.8, -0.4, 0.02, 0.5, 1.5, 1.8, 3.0}) {
        if (axis.z() == 0 && std::abs(angle) > 2) continue;
        const Eigen::Affine3d map = similarity(1.3, angle, mouth.axes * axis);
        const Points redrawn = redrawn_as(map, line.points());
        for (const auto& constraint : curve_constraints(line.handle, {line.mesh.positions, normals}, redrawn))
          ASSERT_LT((*constraint.transform - map.linear()).norm(), 1e-9) << axis.transpose() << ", " << angle;
      }
  }
}

TEST(CurveConstraints, AreContinuousWhereTheCurveLeavesItsSurface) {
  for (const MouthLine& mouth : mouth_lines()) {
    const RuledCurve line = mouth.at_rest();
    SCOPED_TRACE(line.name);
    const Points normals = line.normals(), points = line.points();
    const RestSurface rest{line.mesh.positions, normals};
    const auto turned_over = [&](double share) {
      return curve_constraints(line.handle, rest,
                               redrawn_as(similarity(1, pi * share, mouth.axes.col(0)), points));
    };
    const auto mirrored = [&](double share) {
      return curve_constraints(line.handle, rest, mouth.redrawn(1 - 3 * share));
    };
    // The turn is taken back where the copy comes near the plane again.
    const double step = largest_step(turned_over, 500);
    EXPECT_LT(step, 0.2);
    EXPECT_LT(largest_step(turned_over, 1000), 0.6 * step);
    EXPECT_LT(largest_step(mirrored, 500), 0.01);
  }
}

TEST(RedrawnCurve, KeepsAFlatSheetFlat) {
  // The mouth line of a sheet whose other edges are fixed.
  const MouthLine mouth;
  const RuledCurve line = mouth.at_rest();
  Region region;
  region.whole = true;
  for (Index v = 41; v < line.mesh.vertex_count(); ++v)
    if (v % 41 == 0 || v % 41 == 40 || v >= 8 * 41) region.fixed.push_back(v);
  region.handles = {line.handle};
  const Triangles triangles = triangulate(line.mesh).triangles;
  for (const DeformMethod method :
       {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
    DeformerOptions options;
    options.method = method;
    const Deformer deformer(line.mesh.positions, triangles, region, options);
    for (const double amplitude : {-1.0, -0.5, 0.0, 1.2}) {
      HandlePose pose;
      pose.curve = mouth.redrawn(amplitude);
      const Points result = deformer.evaluate(std::vector{pose});
      EXPECT_LT(result.col(2).cwiseAbs().maxCoeff(), 1e-12) << to_string(method) << ' ' << amplitude;
    }
  }
}

TEST(RedrawnCurve, ActsAsTheSimilarityThatItIsRedrawnBy) {
  // A free dome whose rim is redrawn as its own copy moves as the copy does.
  const Mesh dome = shapes::sheet({.columns = 32, .rows = 10, .close_columns = true, .triangles = true},
                                  [](double u, double v) {
                                    const double a = 2 * pi * u, b = 1.45 * v;
                                    return Eigen::Vector3d(std::cos(b) * std::cos(a), std::cos(b) * std::sin(a),
                                                           1.3 * std::sin(b) + 0.05 * std::sin(3 * a));
                                  });
  Region region;
  region.whole = true;
  std::vector<Index> rim(32);
  for (Index k = 0; k < 32; ++k) rim[k] = k;
  region.handles = {curve(rim, true)};
  const Triangles triangles = triangulate(dome).triangles;
  const double box = (dome.positions.colwise().maxCoeff() - dome.positions.colwise().minCoeff()).norm();
  for (const DeformMethod method :
       {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
    DeformerOptions options;
    options.method = method;
    const Deformer deformer(dome.positions, triangles, region, options);
    for (const double angle : {0.17, pi / 2, 3.0})
      for (const double scale : {1.0, 0.6}) {
        SCOPED_TRACE(std::string(to_string(method)) + ", " + std::to_string(angle));
        const Eigen::Affine3d map = similarity(scale, angle, {1, 0.2, 0.1});
        HandlePose pose;
        pose.curve = redrawn_as(map, dome.positions.topRows(32));
        const Points result = deformer.evaluate(std::vector{pose});
        EXPECT_LT((result - redrawn_as(map, dome.positions)).rowwise().norm().maxCoeff(), 1e-9 * box);
      }
  }
}

}  // namespace
}  // namespace meshgraft
