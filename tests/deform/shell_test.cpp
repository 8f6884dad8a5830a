#include "deform/solve/shell_energy.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>

#include "deform/rotating_methods.h"
#include "deform/solve/shell_relaxation.h"
#include "deform/system_scene.h"
#include "support/limb_cases.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft {
namespace {

using test::SystemScene;

constexpr DeformerOptions as_shell{.method = DeformMethod::shell};

/// A shell over a family's mesh, of which two ends are held.
struct ShellScene {
  SystemScene scene;
  ShellSurface surface;
  ShellPattern pattern;

  explicit ShellScene(const test::TestMesh& mesh)
      : scene(mesh, test::two_handles(test::make_scene(mesh)), as_shell),
        surface(*scene.system, scene.rotations->limbs(), {}),
        pattern(surface, {}) {}

  /// Returns the same stretch everywhere.
  RestStrain strain(const Eigen::Matrix3d& stretch) const {
    return {std::vector(static_cast<std::size_t>(scene.system->patch().size()), stretch), {}};
  }
  const Points& rest() const { return scene.system->patch().points; }
  /// Returns positions near those at rest: each moved by up to a share of an edge.
  Points moved(double share, unsigned seed) const {
    const double edge = scene.system->operators()->mean_edge_length();
    return rest() + share * edge * Points(test::any_columns(rest().rows(), 3, seed));
  }
};

TEST(HingeShape, HasTheGradientsOfItsLengthAndAngle) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const Columns numbers = test::any_columns(4, 3, seed);
    std::array<Eigen::Vector3d, 4> points{Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0),
                                          Eigen::Vector3d(0.4, 1, 0), Eigen::Vector3d(0.6, -1, 0)};
    for (int k = 0; k < 4; ++k) points[static_cast<std::size_t>(k)] += 0.3 * numbers.row(k).transpose();
    const HingeShape shape = hinge_shape(points, true);
    for (std::size_t k = 0; k < 4; ++k)
      for (int axis = 0; axis < 3; ++axis) {
        const double h = 1e-6;
        auto after = points, before = points;
        after[k][axis] += h;
        before[k][axis] -= h;
        const HingeShape high = hinge_shape(after, true), low = hinge_shape(before, true);
        EXPECT_NEAR(shape.angle_slope[k][axis], (high.angle - low.angle) / (2 * h), 1e-7);
        EXPECT_NEAR(shape.length_slope[k][axis], (high.length - low.length) / (2 * h), 1e-7);
      }
  }
}

TEST(HingeShape, IsFlatAtZeroAndChangesSignWithTheFold) {
  const auto angle = [](double height) {
    return hinge_shape({Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(1, 0, 0), Eigen::Vector3d(0.5, 1, 0),
                        Eigen::Vector3d(0.5, -1, height)},
                       true)
        .angle;
  };
  EXPECT_EQ(angle(0), 0);
  EXPECT_NEAR(std::abs(angle(1)), std::atan(1.0), 1e-12);
  EXPECT_EQ(angle(1), -angle(-1));
}

TEST(ShellEnergy, IsZeroAtRestAndItsGradientIsRight) {
  for (const test::TestMesh& mesh : test::small_families()) {
    SCOPED_TRACE(mesh.name);
    const ShellScene shell(mesh);
    if (shell.surface.moving().empty()) continue;  // so few vertices that handles hold all
    const ShellEnergy energy(shell.surface, shell.pattern,
                             shell.surface.metric(shell.strain(Eigen::Matrix3d::Identity()), {}));
    EXPECT_LT(energy.value(shell.rest(), {}), 1e-28);
    const Points at = shell.moved(0.05, 3);
    Eigen::VectorXd descent;
    NormalMatrix curvature;
    energy.differentiate(at, CurvatureModel::tangent, descent, curvature, {});
    const double scale = descent.norm();
    ASSERT_GT(scale, 0);
    for (unsigned seed = 1; seed <= 4; ++seed) {
      const double h = 1e-5 * shell.scene.system->operators()->mean_edge_length();
      Columns direction = Columns::Zero(shell.rest().rows(), 3);
      const Columns numbers = test::any_columns(direction.rows(), 3, seed);
      double slope = 0;
      for (std::size_t u = 0; u < shell.surface.moving().size(); ++u) {
        direction.row(shell.surface.moving()[u]) = numbers.row(shell.surface.moving()[u]);
        slope -=
            numbers.row(shell.surface.moving()[u]).dot(descent.segment<3>(static_cast<Eigen::Index>(3 * u)));
      }
      const double high = energy.value(at + h * Points(direction), {}),
                   low = energy.value(at - h * Points(direction), {});
      EXPECT_NEAR(slope, (high - low) / (2 * h), 1e-4 * scale * direction.norm());
    }
  }
}

TEST(ShellEnergy, DoesNotNoticeRotationsOfTheFieldAndTheSurface) {
  for (const test::TestMesh& mesh : {test::bumpy_sphere(2), test::tube(8, 10)}) {
    const ShellScene shell(mesh);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(2, Eigen::Vector3d(1, -2, 3).normalized()).toRotationMatrix();
    const ShellEnergy still(shell.surface, shell.pattern,
                            shell.surface.metric(shell.strain(Eigen::Matrix3d::Identity()), {})),
        other(shell.surface, shell.pattern, shell.surface.metric(shell.strain(turn), {}));
    const Points at = shell.moved(0.1, 5);
    const double energy = still.value(at, {});
    EXPECT_NEAR(other.value(at, {}), energy, 1e-12 * energy);
    EXPECT_NEAR(still.value(at * turn.transpose(), {}), energy, 1e-12 * energy);
  }
}

TEST(ShellEnergy, IsZeroWhereTheSurfaceHasTheStretchOfTheField) {
  const ShellScene shell(test::irregular_grid(12, 9));
  Eigen::Matrix3d map;
  map << 2, 0.5, 0, 0, 1.5, -0.3, 0.2, 0, 0.7;
  const ShellEnergy energy(shell.surface, shell.pattern, shell.surface.metric(shell.strain(map), {}));
  EXPECT_LT(energy.value(shell.rest() * map.transpose(), {}), 1e-26);
  EXPECT_GT(energy.value(shell.rest(), {}), 1e-3);
}

/// Returns what a limb is to look like with its top turned.
RestStrain strain_of(const SystemScene& scene, double degrees) {
  return scene.rotations->find(scene.constraints(std::vector{test::top_turned(degrees)}), {}).strain;
}

TEST(ShellSurface, WantsTheHelixWhereALimbIsTwisted) {
  for (const bool square : {false, true})
    for (const double radii : {8.0, 20.0}) {
      const test::Limb limb = test::make_limb({.square = square, .radii = radii});
      SCOPED_TRACE(limb.mesh.name);
      Region region{.whole = true, .fixed = limb.bottom};
      region.handles.push_back({.name = "top", .vertices = limb.top});
      const SystemScene scene(limb.mesh, region, as_shell);
      const ShellSurface surface(*scene.system, scene.rotations->limbs(), {});
      const Patch& patch = scene.system->patch();
      const double degrees = 180 * radii / 8;
      const ShellSurface::Metric wanted = surface.metric(strain_of(scene, degrees), {});
      Points helix = test::helix(limb, degrees)(patch.vertices, Eigen::all);
      helix = (helix.rowwise() - patch.centre) / patch.scale;
      double error = 0, change = 0, length_error = 0, length_change = 0;
      for (std::size_t h = 0; h < surface.hinges().size(); ++h) {
        const Hinge& hinge = surface.hinges()[h];
        if (hinge.vertices[3] < 0 || hinge.bending > 1.01) continue;  // at a rim
        const HingeShape rest = hinge_shape(surface.points(hinge, patch.points), true),
                         twisted = hinge_shape(surface.points(hinge, helix), true);
        error += std::pow(std::remainder(twisted.angle - wanted.angles[h], 2 * std::numbers::pi), 2);
        change += std::pow(std::remainder(twisted.angle - rest.angle, 2 * std::numbers::pi), 2);
        length_error += std::pow(twisted.length - wanted.lengths[h], 2);
        length_change += std::pow(twisted.length - rest.length, 2);
      }
      EXPECT_LT(std::sqrt(error / change), 0.1);
      EXPECT_LT(std::sqrt(length_error / length_change), 0.1);
    }
}

TEST(ShellSurface, HoldsConstraintsFeaturesAndAnchorsAndLooseParts) {
  const test::TestMesh mesh = test::tube(14, 30);
  const test::Scene scene = test::make_scene(mesh);
  Region region = test::two_handles(scene);
  std::vector<Index> middle;
  for (Index v = 0; v < mesh.size(); ++v)
    if (std::find(scene.foot.begin(), scene.foot.end(), v) == scene.foot.end() &&
        std::find(scene.head.begin(), scene.head.end(), v) == scene.head.end())
      middle.push_back(v);
  region.anchors.push_back({.vertex = middle[5]});
  region.features.push_back({.vertices = {middle[20], middle[21]}});
  const SystemScene held(mesh, region, as_shell);
  const ShellSurface surface(*held.system, held.rotations->limbs(), {});
  for (const Index v : {middle[5], middle[20], middle[21]})
    EXPECT_EQ(surface.unknown(held.system->patch().local(v)), -1);
  // Two vertices of a feature have no face between them, so that their rings are held, too.
  EXPECT_LT(surface.moving().size(), middle.size() - 3);
  EXPECT_GT(surface.moving().size(), middle.size() - 20);
}

TEST(Shell, BendsMoreEvenlyThanTheDefaultAndDoesNotKink) {
  for (const bool square : {false, true}) {
    const test::Limb limb = test::make_limb({.square = square, .radii = 8});
    SCOPED_TRACE(limb.mesh.name);
    Region region{.whole = true, .fixed = limb.bottom};
    region.handles.push_back({.name = "top", .vertices = limb.top});
    HandleMotion motion;
    motion.axis = Eigen::Vector3d::UnitX();
    motion.angle_deg = 100;
    const HandlePose bent = make_pose(motion, Eigen::Vector3d(0, 0, limb.length / 2));
    const auto quality = [&](const DeformerOptions& options) {
      const Deformer deformer(limb.mesh.positions, limb.mesh.triangles, region, options);
      const Points edited = deformer.evaluate(std::span(&bent, 1));
      return measure_quality({limb.mesh.positions, edited, limb.mesh.triangles, deformer.free_vertices()});
    };
    const Quality usual = quality({}), shell = quality(as_shell);
    EXPECT_LT(shell.edge_rms * shell.dihedral_p99_deg, usual.edge_rms * usual.dihedral_p99_deg);
    EXPECT_LT(shell.dihedral_max_deg, usual.dihedral_max_deg);
    EXPECT_LT(shell.rim_jump_max_deg, usual.rim_jump_max_deg);
    EXPECT_EQ(shell.flipped_faces, 0);
    EXPECT_EQ(shell.new_self_intersections, 0);
  }
}

TEST(Shell, IsNotStoppedByFacesAndEdgesThatCannotChange) {
  const test::TestMesh clean = test::tube(14, 30);
  const test::Scene scene = test::make_scene(clean);
  const std::vector poses{test::pose_of(test::head_move(scene))};
  const Points expected = test::make_deformer(scene, test::held_foot(scene), as_shell).evaluate(poses);
  std::vector<Index> held, free;  // beside each other: a held vertex with a free neighbour, and two free ones
  const Region region = test::held_foot(scene);
  Flags is_held(static_cast<std::size_t>(clean.size()), 0);
  for (const Index v : region.fixed) is_held[v] = 1;
  for (const auto& t : clean.triangles.rowwise()) {
    const auto count = std::count_if(t.begin(), t.end(), [&](Index v) { return is_held[v] != 0; });
    if (held.empty() && count == 2)
      for (const Index v : t)
        if (is_held[v]) held.push_back(v);
    if (free.empty() && count == 0) free = {t[0], t[1]};
  }
  for (const auto& pair : {held, free})
    for (const double apart : {0.0, 1e-12, 1e-8, 1e-4}) {
      SCOPED_TRACE(apart);
      test::Scene other = scene;
      Points& points = other.mesh.positions;
      points.row(pair[1]) = points.row(pair[0]) + apart * (points.row(pair[1]) - points.row(pair[0]));
      EvaluationReport report;
      const Points result =
          test::make_deformer(other, test::held_foot(other), as_shell).evaluate(poses, {}, &report);
      EXPECT_GT(report.shell_steps, 0);
      EXPECT_TRUE(report.shell_settled);
      EXPECT_LT(test::relative_distance(clean, result, expected), 0.1);
    }
}

TEST(Shell, TurnsWithPointsAndCurves) {
  const test::TestMesh mesh = test::irregular_grid(30, 30);
  std::vector<Index> border, middle;
  const Eigen::RowVector3d centre = mesh.positions.colwise().mean();
  Eigen::Index nearest = 0;
  (mesh.positions.rowwise() - centre).rowwise().norm().minCoeff(&nearest);
  for (Index v = 0; v < mesh.size(); ++v)
    if ((mesh.positions.row(v) - centre).norm() > 0.3 * mesh.box_diagonal()) border.push_back(v);
  Region region{.whole = true, .fixed = border};
  region.handles.push_back(
      {.name = "point", .shape = HandleShape::vertex, .vertices = {static_cast<Index>(nearest)}});
  HandleMotion motion;
  motion.axis = Eigen::Vector3d::UnitX();
  motion.angle_deg = 50;
  const HandlePose pose = make_pose(motion, mesh.positions.row(nearest).transpose());
  const auto turned = [&](DeformMethod method) {
    const Deformer deformer(mesh.positions, mesh.triangles, region, {.method = method});
    EvaluationReport report;
    const Points edited = deformer.evaluate(std::span(&pose, 1), {}, &report);
    return std::pair{(edited - mesh.positions).rowwise().norm().maxCoeff(), report.max_transform_deviation};
  };
  const auto [usual, usual_deviation] = turned(DeformMethod::corotational);
  const auto [shell, deviation] = turned(DeformMethod::shell);
  EXPECT_GT(shell, 0.8 * usual);
  EXPECT_NEAR(deviation, usual_deviation, 1e-9);
}

TEST(Shell, OfAComponentDoesNotDependOnLargerOnes) {
  const test::TestMesh limb = test::tube(14, 30);
  const test::Scene scene = test::make_scene(limb);
  const std::vector alone{test::pose_of(test::head_move(scene))};
  const Points expected = test::make_deformer(scene, test::held_foot(scene), as_shell).evaluate(alone);
  const Eigen::Affine3d grow(Eigen::Translation3d(0, 0, 3000) * Eigen::Scaling(300.0));
  Points points(2 * limb.size(), 3);
  points << limb.positions, test::image(limb.positions, grow);
  Triangles triangles(2 * limb.triangles.rows(), 3);
  triangles << limb.triangles, limb.triangles.array() + limb.size();
  Region region = test::held_foot(scene);
  region.handles.push_back(region.handles[0]);
  region.handles[1].name = "large";
  for (Index& v : region.handles[1].vertices) v += limb.size();
  const std::vector<Index> foot = region.fixed;
  for (const Index v : foot) region.fixed.push_back(v + limb.size());
  const HandlePose large = test::pose_of(grow * alone[0].transform * grow.inverse());
  const Points both = Deformer(points, triangles, region, as_shell).evaluate(std::vector{alone[0], large});
  EXPECT_LT(test::relative_distance(limb, both.topRows(limb.size()), expected), 1e-4);
}

TEST(Shell, SettlesAndSaysSo) {
  for (const test::TestMesh& mesh : test::mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const test::Scene scene = test::make_scene(mesh);
    EvaluationReport report;
    const Points edited = test::make_deformer(scene, test::held_foot(scene), as_shell)
                              .evaluate(std::vector{test::pose_of(test::head_move(scene))}, {}, &report);
    EXPECT_TRUE(edited.allFinite());
    EXPECT_TRUE(report.shell_settled || mesh.name == "needle sheet");
    EXPECT_LE(report.shell_steps, 30);
  }
}

TEST(Shell, GivesTheSameBytesWithAnyNumberOfThreads) {
  const test::TestMesh mesh = test::bumpy_sphere(4);
  const test::Scene scene = test::make_scene(mesh);
  const std::vector poses{test::pose_of(test::head_move(scene))};
  const auto edited = [&](int threads) {
    const Deformer deformer(mesh.positions, mesh.triangles, test::held_foot(scene), as_shell,
                            {.threads = threads});
    return deformer.evaluate(poses, {.threads = threads});
  };
  EXPECT_TRUE(test::same_bytes(edited(1), edited(2)));
}

TEST(Shell, IsFoundByBothDirectBackends) {
  const test::TestMesh mesh = test::tube(14, 30);
  const test::Scene scene = test::make_scene(mesh);
  const std::vector poses{test::pose_of(test::head_move(scene))};
  DeformerOptions eigen = as_shell;
  eigen.backend = SolverBackend::eigen;
  const Points a = test::make_deformer(scene, test::held_foot(scene), as_shell).evaluate(poses),
               b = test::make_deformer(scene, test::held_foot(scene), eigen).evaluate(poses);
  EXPECT_LT(test::relative_distance(mesh, a, b), 1e-8);
}

}  // namespace
}  // namespace meshgraft
