#include "deform/solve/limb_twist.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>
#include <meshgraft/deform/quick_frames.h>
#include <meshgraft/mesh/topology.h>

#include "deform/reduced/twist_modes.h"
#include "deform/solve/limb_faces.h"
#include "support/limb_cases.h"
#include "support/mesh_families.h"

namespace meshgraft {
namespace {

/// The limbs of a mesh with maps given at some vertices.
LimbTwist limbs_of(const test::TestMesh& mesh, const Flags& given) {
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  const auto bisection = std::make_shared<BisectionTree>();
  const IntrinsicEdges edges = intrinsic_delaunay_edges(mesh.positions, mesh.triangles);
  const FieldSurface surface{mesh.positions, mesh.triangles, rings, edges, bisection};
  const SurfaceFields fields(surface, given, std::make_shared<BendingMatrix>(surface, Context()));
  return {surface, fields, GroupWeights(rings, given, fields, {}), SolverBackend::automatic, {}};
}

/// The same with maps given at both ends.
LimbTwist limbs_of(const test::Limb& limb) {
  Flags given(static_cast<std::size_t>(limb.mesh.size()), 1);
  for (const Index v : limb.middle) given[v] = 0;
  return limbs_of(limb.mesh, given);
}

std::vector<test::LimbShape> limb_shapes() {
  std::vector<test::LimbShape> shapes;
  for (const double radii : {4.0, 8.0, 20.0})
    for (const bool square : {false, true}) {
      shapes.push_back({.square = square, .radii = radii});
      shapes.push_back({.square = square, .radii = radii, .uneven = true, .closed = true});
    }
  return shapes;
}

Deformer twisted(const test::Limb& limb, DeformMethod method) {
  Region region{.whole = true, .fixed = limb.bottom};
  region.handles.push_back({.name = "top", .vertices = limb.top});
  return {limb.mesh.positions, limb.mesh.triangles, region, {.method = method}};
}

TEST(LimbTwist, FindsAxisAndCentreLineOfAPipe) {
  for (const test::LimbShape& shape : limb_shapes()) {
    const test::Limb limb = test::make_limb(shape);
    const LimbTwist limbs = limbs_of(limb);
    ASSERT_FALSE(limbs.empty()) << limb.mesh.name;
    for (const Index v : limb.middle) {
      const double up = limbs.at(v).axis[2] > 0 ? 1 : -1;
      const Eigen::Vector3d offset(limb.mesh.positions(v, 0), limb.mesh.positions(v, 1), 0);
      EXPECT_GT(up * limbs.at(v).axis[2], 0.99) << limb.mesh.name;
      const Eigen::Vector3d moment = up * Eigen::Vector3d::UnitZ().cross(offset);
      EXPECT_LT((limbs.at(v).moment - moment).norm(), 0.03) << limb.mesh.name;
    }
    for (const Index v : limb.top) EXPECT_TRUE(limbs.at(v).moment.isZero(0));
  }
}

TEST(LimbTwist, FindsTheSlopeOfWholeSections) {
  const double rate = 0.3, wave = 0.5;
  for (const test::LimbShape& shape : limb_shapes()) {
    const test::Limb limb = test::make_limb(shape);
    const LimbTwist limbs = limbs_of(limb);
    ASSERT_FALSE(limbs.empty()) << limb.mesh.name;
    Columns turns(limb.mesh.size(), 2);  // in proportion to the height; the same with a wave around the limb
    for (Index v = 0; v < limb.mesh.size(); ++v) {
      const Eigen::RowVector3d point = limb.mesh.positions.row(v);
      turns(v, 0) = rate * point[2];
      turns(v, 1) = turns(v, 0) + wave * point[2] / limb.length * std::sin(3 * std::atan2(point[1], point[0]));
    }
    const Columns slopes = limbs.slopes(turns, {});
    for (const Index v : limb.middle) {
      const double up = limbs.at(v).axis[2] > 0 ? 1 : -1;
      EXPECT_NEAR(up * slopes(v, 0), rate, 0.02 * rate) << limb.mesh.name;
      EXPECT_NEAR(up * slopes(v, 1), rate, 0.2 * wave / limb.length) << limb.mesh.name;
    }
  }
}

/// A sheet, flat or bumpy, whose maps are given in a disc and beyond a circle. Its vertices in between are
/// free.
struct DiscInSheet {
  test::TestMesh mesh = test::irregular_grid(40, 40);
  Eigen::RowVector3d centre = mesh.positions.colwise().mean();
  std::vector<Index> disc, border, free;
  Flags given = Flags(static_cast<std::size_t>(mesh.size()), 0);

  explicit DiscInSheet(bool is_flat = true) {
    if (is_flat) mesh.positions.col(2).setConstant(centre[2]);
    for (Index v = 0; v < mesh.size(); ++v) {
      const double distance = (mesh.positions.row(v) - centre).norm() / mesh.box_diagonal();
      (distance < 0.07 ? disc : distance > 0.32 ? border : free).push_back(v);
      given[v] = distance < 0.07 || distance > 0.32 ? 1 : 0;
    }
  }
};

/// Returns how much of the strain that a turn causes the functions leave out, relative to its norm.
double left_out(const LimbTwist& limbs, const Columns& influence, const Columns& functions, double turn) {
  const Columns slopes = limbs.slopes(influence, {});
  Eigen::MatrixXd strains(functions.rows(), 2), fitted = functions;
  for (Eigen::Index v = 0; v < functions.rows(); ++v) {
    const LimbPoint at = limbs.at(v);
    const double rate = twist_rate(at, turn * std::abs(slopes(v, 0))), angle = turn * influence(v, 0);
    strains.row(v) << rate * std::cos(angle), rate * std::sin(angle);
    strains.row(v) *= at.moment.norm();
    fitted.row(v) *= at.moment.norm();
  }
  const Eigen::MatrixXd fit = fitted.colPivHouseholderQr().solve(strains);
  return (fitted * fit - strains).norm() / strains.norm();
}

TEST(TwistModes, SpanTheStrainsThatAHandleCauses) {
  const auto check = [](const LimbTwist& limbs, const Columns& influence, double bound) {
    std::vector<Index> points;
    for (Index v = 0; v < influence.rows(); ++v)
      if (!limbs.at(v).moment.isZero(0)) points.push_back(v);
    const std::vector<Index> handles{0};
    const Columns modes = twist_modes(limbs, influence, limbs.slopes(influence, {}), points, handles, 20, {});
    ASSERT_EQ(modes.cols(), 20);
    for (const double turn_deg : {50.0, 90.0, 200.0, 500.0})
      EXPECT_LT(left_out(limbs, influence, modes, turn_deg * std::numbers::pi / 180), bound) << turn_deg;
  };
  for (const test::LimbShape& shape : limb_shapes()) {
    SCOPED_TRACE(test::make_limb(shape).mesh.name);
    const test::Limb limb = test::make_limb(shape);
    check(limbs_of(limb), limb.mesh.positions.col(2) / limb.length, 1e-3);
  }
  for (const bool is_flat : {true, false}) {
    const DiscInSheet sheet(is_flat);
    Columns influence = Columns::Zero(sheet.mesh.size(), 1);  // harmonic around a disc
    for (Index v = 0; v < sheet.mesh.size(); ++v) {
      const double distance = (sheet.mesh.positions.row(v) - sheet.centre).norm() / sheet.mesh.box_diagonal();
      influence(v, 0) = std::clamp(std::log(0.32 / distance) / std::log(0.32 / 0.07), 0.0, 1.0);
    }
    check(limbs_of(sheet.mesh, sheet.given), influence, 0.02);
  }
}

TEST(LimbTwist, FindsAxisAndCentreOfADisc) {
  const DiscInSheet sheet;
  const LimbTwist limbs = limbs_of(sheet.mesh, sheet.given);
  ASSERT_FALSE(limbs.empty());
  Columns turns(sheet.mesh.size(), 1);  // in proportion to the distance from the centre
  for (Index v = 0; v < sheet.mesh.size(); ++v)
    turns(v, 0) = 0.3 * (sheet.mesh.positions.row(v) - sheet.centre).norm();
  const Columns slopes = limbs.slopes(turns, {});
  for (const Index v : sheet.free) {
    const LimbPoint at = limbs.at(v);
    const Eigen::Vector3d offset = (sheet.mesh.positions.row(v) - sheet.centre).transpose();
    EXPECT_TRUE(is_on_disc(at));
    EXPECT_GT(std::abs(at.axis[2]), 1 - 1e-9);
    EXPECT_GT(at.direction.dot(offset.normalized()), 0.9);
    EXPECT_LT((at.moment - at.axis.cross(offset)).norm(), 0.12 * offset.norm());
    EXPECT_NEAR(slopes(v, 0), 0.3, 0.03);
  }
}

TEST(LimbTwist, AxesOfADiscPointToOneSideOfTheSheet) {
  for (const bool is_flat : {true, false}) {
    const DiscInSheet sheet(is_flat);
    const LimbTwist limbs = limbs_of(sheet.mesh, sheet.given);
    ASSERT_FALSE(limbs.empty());
    for (const Index v : sheet.free)
      if (const LimbPoint at = limbs.at(v); is_on_disc(at)) {
        EXPECT_GT(at.axis[2], 0.5);
      }
  }
}

TEST(LimbTwist, OfADiscWindsUpTheSheetAroundIt) {
  const DiscInSheet sheet;
  Region region{.whole = true, .fixed = sheet.border};
  region.handles.push_back({.name = "disc", .vertices = sheet.disc});
  const Deformer deformer(sheet.mesh.positions, sheet.mesh.triangles, region);
  for (const auto& [degrees, most_flipped] :
       {std::pair{60.0, 0.0}, {120.0, 0.002}, {-150.0, 0.005}, {180.0, 0.02}}) {
    HandleMotion motion;
    motion.axis = Eigen::Vector3d::UnitZ();
    motion.angle_deg = degrees;
    const HandlePose pose = make_pose(motion, sheet.centre.transpose());
    const Points turned = deformer.evaluate(std::span(&pose, 1));
    const Quality quality = measure_quality({sheet.mesh.positions, turned, sheet.mesh.triangles, sheet.free});
    EXPECT_LE(static_cast<double>(quality.flipped_faces),
              most_flipped * static_cast<double>(sheet.mesh.triangles.rows()))
        << degrees;
    // Circles around the centre stay round.
    for (const Index v : sheet.free)
      EXPECT_NEAR((turned.row(v) - sheet.centre).norm(), (sheet.mesh.positions.row(v) - sheet.centre).norm(),
                  0.05 * sheet.mesh.box_diagonal())
          << degrees;
  }
}

/// A disc, and the part of a flat sheet of unit size that is free around it. The sheet's border may cut both.
struct CutDisc {
  Eigen::RowVector2d centre;
  double disc = 0, region = 0;  ///< radii
};

/// Returns the number of faces upside down after the disc's turn. Without strain, a single held vertex beside
/// the free part is a third group of given maps, besides which there are no discs.
Index flipped_by_turn(const CutDisc& cut, double degrees, bool with_strain) {
  constexpr int cells = 40;
  test::TestMesh mesh = test::irregular_grid(cells, cells);
  mesh.positions.col(2).setZero();
  const Eigen::RowVector3d low = mesh.positions.colwise().minCoeff(),
                           high = mesh.positions.colwise().maxCoeff();
  const double size = high[0] - low[0];
  const Eigen::RowVector3d centre = low + size * Eigen::RowVector3d(cut.centre[0], cut.centre[1], 0);
  Region region{.whole = true};
  region.handles.push_back({.name = "disc"});
  Flags is_held(static_cast<std::size_t>(mesh.size()), 0);
  std::vector<Index> free;
  Index beside = 0;  // the vertex nearest to a circle four cells beyond the free part
  const auto radius = [&](Index v) { return (mesh.positions.row(v) - centre).norm() / size; };
  const auto off_circle = [&](Index v) { return std::abs(radius(v) - cut.region - 4.0 / cells); };
  for (Index v = 0; v < mesh.size(); ++v) {
    if (off_circle(v) < off_circle(beside)) beside = v;
    if (radius(v) < cut.disc) region.handles[0].vertices.push_back(v);
    if (radius(v) > cut.region) is_held[v] = 1;
    if (radius(v) >= cut.disc && radius(v) <= cut.region) free.push_back(v);
  }
  const IndexLists rings = vertex_rings(mesh.size(), mesh.triangles);
  if (!with_strain)
    for (const Index v : rings[beside]) is_held[v] = 0;
  for (Index v = 0; v < mesh.size(); ++v)
    if (is_held[v]) region.fixed.push_back(v);
  HandleMotion motion;
  motion.axis = Eigen::Vector3d::UnitZ();
  motion.angle_deg = degrees;
  const HandlePose pose = make_pose(motion, centre.transpose());
  const Points turned = Deformer(mesh.positions, mesh.triangles, region).evaluate(std::span(&pose, 1));
  return measure_quality({mesh.positions, turned, mesh.triangles, free}).flipped_faces;
}

// The turn falls with the logarithm of the distance from the centre, so that the sheet is sheared by the angle
// over ln(region / disc) everywhere. Where that is more, both fold (docs/methods.md).
TEST(LimbTwist, OfDiscsFlipsNoMoreFacesThanWithoutStrain) {
  constexpr double largest_slope = 2.4;
  for (const Eigen::RowVector2d& centre :
       {Eigen::RowVector2d(0.5, 0.5), Eigen::RowVector2d(0.5, 0), Eigen::RowVector2d(0, 0)})
    for (const double disc : {0.1, 0.15, 0.2})
      for (const double region : {0.3, 0.36, 0.42})
        for (const double degrees : {60.0, 120.0, 180.0}) {
          if (degrees * std::numbers::pi / 180 / std::log(region / disc) > largest_slope) continue;
          const CutDisc cut{centre, disc, region};
          EXPECT_LE(flipped_by_turn(cut, degrees, true), flipped_by_turn(cut, degrees, false))
              << centre << ": " << disc << ", " << region << ", " << degrees;
        }
}

TEST(LimbTwist, FindsNoDiscBesideOtherHandles) {
  DiscInSheet sheet;
  const double size = sheet.mesh.box_diagonal();
  for (const Index v : sheet.free)
    if ((sheet.mesh.positions.row(v) - sheet.centre - Eigen::RowVector3d(0.2 * size, 0, 0)).norm() <
        0.03 * size)
      sheet.given[v] = 1;
  EXPECT_TRUE(limbs_of(sheet.mesh, sheet.given).empty());
}

// Level lines around a disc become longer, until t is the same all along them.
TEST(LimbTwist, FadesBetweenDiscsAndLimbs) {
  constexpr int steps = 1000;
  const Eigen::RowVector3d point(0.6, 0.3, 0.2), t = point.normalized();
  const auto moment_of = [&](double elongation) {
    Eigen::Matrix<double, 1, 9> means = Eigen::Matrix<double, 1, 9>::Zero();
    means.segment<3>(3) << (1 + elongation) / 2, (1 - elongation) / 2, 0;
    return limb_at(point, t, means, true).moment.norm();
  };
  EXPECT_NEAR(moment_of(0), point.head<2>().norm(), 1e-12);
  EXPECT_NEAR(moment_of(1), point.tail<2>().norm(), 1e-12);
  EXPECT_EQ(moment_of(least_elongation), 0);
  for (int k = 0; k < steps; ++k) {
    const double elongation = static_cast<double>(k) / steps;
    EXPECT_NEAR(moment_of(elongation + 1.0 / steps), moment_of(elongation), 0.01) << elongation;
  }
}

TEST(LimbTwist, OfADiscServesLargeTurnsInItsPlaneAlone) {
  const DiscInSheet sheet;
  const LimbTwist limbs = limbs_of(sheet.mesh, sheet.given);
  const Eigen::Matrix3d rest = Eigen::Matrix3d::Identity();
  for (const Index v : sheet.free) {
    const LimbPoint at = limbs.at(v);
    const double radius = at.moment.norm();
    // Returns the length of the strain of a turn about a direction that shears by `slope`.
    const auto strain = [&](const Eigen::Vector3d& about, double slope) {
      return (twist_shear(at, about, slope / radius * about, rest, rest) * at.moment).norm();
    };
    EXPECT_LT(strain(Eigen::Vector3d::UnitX(), 2), 1e-12);
    EXPECT_LT(strain(Eigen::Vector3d::UnitZ(), 0.5), 0.01);
    EXPECT_NEAR(strain(Eigen::Vector3d::UnitZ(), 1.5), 1.5, 0.15);
    EXPECT_LT(strain(Eigen::Vector3d::UnitZ(), 20), 1);
  }
}

TEST(LimbTwist, FindsTheAxisBetweenManyHandles) {
  // Scattered single vertices hold both ends: more groups than there are columns.
  const test::Limb limb = test::make_limb({.radii = 8});
  Flags given(static_cast<std::size_t>(limb.mesh.size()), 0);
  for (std::size_t k = 0; k < limb.bottom.size(); k += 5) given[limb.bottom[k]] = given[limb.top[k]] = 1;
  const LimbTwist limbs = limbs_of(limb.mesh, given);
  ASSERT_FALSE(limbs.empty());
  for (const Index v : limb.middle)
    if (std::abs(limb.mesh.positions(v, 2) - limb.length / 2) < limb.length / 4) {
      EXPECT_GT(std::abs(limbs.at(v).axis[2]), 0.9);
    }
}

class Twists : public testing::TestWithParam<test::LimbShape> {};

/// The bounds are those of limbs with eight radii; the angle per length counts.
TEST_P(Twists, KeepTheWidthOfALimb) {
  const test::Limb limb = test::make_limb(GetParam());
  const double lengths = GetParam().radii / 8;
  // The edges and flat sides of a square pipe cost more than the surface of the helix, which has none to spare.
  const double most = GetParam().square ? 1.17 : 1.05;
  for (const DeformMethod method :
       {DeformMethod::rotation_aware, DeformMethod::corotational, DeformMethod::shell}) {
    const Deformer deformer = twisted(limb, method);
    for (const auto& [degrees, narrowest] : {std::pair{180.0, 0.95}, std::pair{360.0, 0.9}}) {
      const HandlePose pose = test::top_turned(degrees * lengths);
      const Points edited = deformer.evaluate(std::span(&pose, 1));
      const Points ideal = test::helix(limb, degrees * lengths);
      const auto quality = [&](const Points& points) {
        return measure_quality({limb.mesh.positions, points, limb.mesh.triangles, limb.middle});
      };
      const Quality ours = quality(edited), helix = quality(ideal);
      const std::string where = limb.mesh.name + ", " + std::string(to_string(method));
      EXPECT_GT(test::waist(limb, edited), narrowest) << where;
      EXPECT_LT(ours.edge_rms * ours.dihedral_p99_deg, most * helix.edge_rms * helix.dihedral_p99_deg) << where;
      ASSERT_EQ(helix.new_self_intersections, 0) << where;
      EXPECT_EQ(ours.new_self_intersections, 0) << where;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(OfLimbs, Twists, testing::ValuesIn(limb_shapes()));

TEST(Twists, OfStretchedLimbsKeepTheirWidth) {
  const test::Limb limb = test::make_limb({.radii = 8});
  Region region{.whole = true};
  region.handles.push_back({.name = "bottom", .vertices = limb.bottom});
  region.handles.push_back({.name = "top", .vertices = limb.top});
  for (const Eigen::Vector3d& scale :
       {Eigen::Vector3d(1, 1, 3), Eigen::Vector3d(1, 1, 0.6), Eigen::Vector3d(2, 2, 2)})
    for (const DeformMethod method : {DeformMethod::rotation_aware, DeformMethod::corotational}) {
      const Deformer deformer(limb.mesh.positions, limb.mesh.triangles, region, {.method = method});
      HandlePose poses[] = {test::top_turned(0), test::top_turned(270)};
      for (HandlePose& pose : poses) pose.transform.linear() *= scale.asDiagonal();
      const Points edited = deformer.evaluate(poses);
      EXPECT_GT(test::waist(limb, edited), 0.95 * scale[0]) << scale.transpose() << ", " << to_string(method);
      for (const Index v : limb.middle)
        EXPECT_LT(edited.row(v).head<2>().norm(), 1.05 * scale[0] * 0.5)
            << scale.transpose() << ", " << to_string(method);
    }
}

TEST(Twists, AreSolvedIterativelyAndPastNeedles) {
  const test::Limb limb = test::make_limb({.radii = 20});
  Region region{.whole = true, .fixed = limb.bottom};
  region.handles.push_back({.name = "top", .vertices = limb.top});
  const HandlePose pose = test::top_turned(180);
  const Points direct =
      Deformer(limb.mesh.positions, limb.mesh.triangles, region, {}).evaluate(std::span(&pose, 1));
  const Points iterative =
      Deformer(limb.mesh.positions, limb.mesh.triangles, region, {.backend = SolverBackend::iterative})
          .evaluate(std::span(&pose, 1));
  EXPECT_LT((iterative - direct).rowwise().norm().maxCoeff(), 1e-3);
  for (const double squeezed : {1e-4, 1e-5, 3e-6}) {
    Points rest = limb.mesh.positions;  // rings between 4 and 6 are squeezed together
    for (auto point : rest.rowwise())
      point[2] = point[2] < 4   ? point[2]
                 : point[2] > 6 ? point[2] - 2 + 2 * squeezed
                                : 4 + squeezed * (point[2] - 4);
    const Deformer deformer(rest, limb.mesh.triangles, region, {});
    EXPECT_TRUE(deformer.evaluate(std::span(&pose, 1)).allFinite()) << squeezed;
  }
}

TEST(Twists, OfBothEndsAgainstEachOtherKeepTheWidth) {
  const test::Limb limb = test::make_limb({.radii = 8});
  Region region{.whole = true};
  region.handles.push_back({.name = "bottom", .vertices = limb.bottom});
  region.handles.push_back({.name = "top", .vertices = limb.top});
  const Deformer deformer(limb.mesh.positions, limb.mesh.triangles, region, {});
  const HandlePose poses[] = {test::top_turned(-170), test::top_turned(170)};
  EXPECT_GT(test::waist(limb, deformer.evaluate(poses)), 0.9);
}

TEST(Twists, MoveContinuouslyThroughTwoTurnsAndBack) {
  const test::Limb limb = test::make_limb({.radii = 8});
  const double step = 40;
  const double arc = step * std::numbers::pi / 180 * 0.5;
  for (const DeformMethod method : {DeformMethod::corotational, DeformMethod::shell}) {
    const Deformer deformer = twisted(limb, method);
    Points last = limb.mesh.positions;
    std::vector<Points> frames;
    for (double degrees = step; degrees <= 720; degrees += step) {
      const HandlePose pose = test::top_turned(degrees);
      frames.push_back(deformer.evaluate(std::span(&pose, 1)));
      EXPECT_LT((frames.back() - last).rowwise().norm().maxCoeff(), 1.1 * arc)
          << degrees << ", " << to_string(method);
      last = frames.back();
    }
    const HandlePose back = test::top_turned(360);
    EXPECT_EQ(deformer.evaluate(std::span(&back, 1)), frames[8]);
  }
}

TEST(Twists, AreShownByReducedFrames) {
  const test::Limb limb = test::make_limb({.radii = 8});
  for (const DeformMethod method : {DeformMethod::rotation_aware, DeformMethod::corotational}) {
    const Deformer deformer = twisted(limb, method);
    const ReducedFrames frames(deformer, {.centres = 128});
    for (const auto& [degrees, largest] : {std::pair{90.0, 0.01}, {180.0, 0.015}, {360.0, 0.03}}) {
      const HandlePose pose = test::top_turned(degrees);
      const Points exact = deformer.evaluate(std::span(&pose, 1)), frame = frames.frame(std::span(&pose, 1));
      const double moved = (exact - limb.mesh.positions).rowwise().norm().maxCoeff();
      EXPECT_LT((frame - exact).rowwise().norm().maxCoeff(), largest * moved)
          << degrees << ", " << to_string(method);
      EXPECT_GT(test::waist(limb, frame), degrees > 180 ? 0.9 : 0.95) << degrees;
    }
  }
}

}  // namespace
}  // namespace meshgraft
