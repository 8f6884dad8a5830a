// Laws of the rotation-aware and co-rotational methods beyond those of the linear one, and their advantages.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quality.h>

#include "support/density_cases.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Affine3d;
using Eigen::AngleAxisd;
using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr DeformMethod rotating_methods[] = {DeformMethod::rotation_aware, DeformMethod::corotational};

DeformerOptions options_of(DeformMethod method, double stiffness = DeformerOptions{}.stiffness) {
  return {.method = method, .stiffness = stiffness};
}

std::string describe(const DeformerOptions& options) {
  return std::string(to_string(options.method)) + ", stiffness " + std::to_string(options.stiffness);
}

/// Returns the options of both methods, with and without stiffness.
std::vector<DeformerOptions> method_variants() {
  std::vector<DeformerOptions> variants;
  for (const DeformMethod method : rotating_methods)
    for (const double stiffness : {0.0, DeformerOptions{}.stiffness})
      variants.push_back(options_of(method, stiffness));
  return variants;
}

Deformer make_deformer(const Scene& scene, const Region& region, const DeformerOptions& options) {
  return {scene.mesh.positions, scene.mesh.triangles, region, options};
}

Points edit_head(const Scene& scene, const DeformerOptions& options) {
  return make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(head_move(scene))});
}

/// Returns the tolerance for rounding. Co-rotational steps amplify it in badly conditioned solves, so that
/// triangles of 1:1000 cost a digit.
double step_tolerance(const TestMesh& mesh, const DeformerOptions& options) {
  const bool needles =
      mesh.name.find("needle") != std::string::npos || mesh.name.find("fan pole") != std::string::npos;
  return needles && options.method == DeformMethod::corotational ? 1e-8 : 1e-9;
}

/// Returns the largest distance over the vertices of faces, relative to the box.
double relative_distance(const TestMesh& mesh, const Points& a, const Points& b) {
  double largest = 0;
  for (Index v : mesh.triangles.reshaped()) largest = std::max(largest, (a.row(v) - b.row(v)).norm());
  return largest / mesh.box_diagonal();
}

/// Returns a turn about the head's first vertex that keeps its number of whole turns.
HandlePose turned(const Scene& scene, double angle_deg, const Vector3d& axis = Vector3d(1, -2, 0.5)) {
  HandleMotion motion;
  motion.axis = axis;
  motion.angle_deg = angle_deg;
  return make_pose(motion, scene.mesh.positions.row(scene.head.front()));
}

TEST(Methods, WithNothingTurnedAndNoStiffnessRotationAwareIsLinear) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const std::vector shift{
        pose_of(Affine3d(Eigen::Translation3d(0.1 * mesh.box_diagonal() * Vector3d(1, 2, 3))))};
    const Points aware =
        make_deformer(scene, held_foot(scene), options_of(DeformMethod::rotation_aware, 0)).evaluate(shift);
    EXPECT_TRUE(same_bytes(aware, make_deformer(scene, held_foot(scene), linear_method()).evaluate(shift)));
  }
}

TEST(Methods, NoStepsIsRotationAware) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    DeformerOptions still;
    still.iterations = 0;
    EXPECT_TRUE(
        same_bytes(edit_head(scene, still), edit_head(scene, options_of(DeformMethod::rotation_aware))));
  }
}

TEST(Methods, AffineMapsAreReproduced) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const DeformerOptions& options : method_variants()) {
      const Deformer deformer = make_deformer(scene, two_handles(scene), options);
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + describe(options) + ", " + name);
        const Affine3d map = about_middle(mesh, linear);
        EvaluationReport report;
        const Points result = deformer.evaluate(std::vector{pose_of(map), pose_of(map)}, {}, &report);
        const Points expected = image(mesh.positions, map);
        const double rounding = std::max(eight_ulp(expected), eight_ulp(mesh.positions)) / mesh.box_diagonal();
        EXPECT_LT(relative_distance(mesh, result, expected), std::max(1e-10, rounding));
        EXPECT_EQ(report.fell_back_to_linear, linear.determinant() < 0);
      }
    }
  }
}

TEST(Methods, AnchorsAndFeaturesKeepSimilarities) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh);
    const Affine3d map =
        about_middle(mesh, Matrix3d(1.6 * AngleAxisd(2.1, Vector3d(1, 2, -1).normalized()).toRotationMatrix()));
    Region anchored = two_handles(scene), with_feature = anchored;
    std::vector<bool> held(static_cast<std::size_t>(mesh.size()), false);
    for (const auto* end : {&scene.foot, &scene.head})
      for (Index v : *end) held[static_cast<std::size_t>(v)] = true;
    Feature feature;
    for (Index v = 0; v < mesh.size(); ++v) {
      if (v % 7 == 0) anchored.anchors.push_back({v, 0.5, map * Vector3d(mesh.positions.row(v))});
      if (v % 3 == 0 && !held[static_cast<std::size_t>(v)]) feature.vertices.push_back(v);
    }
    with_feature.features = {feature};
    for (const DeformerOptions& options : method_variants())
      for (const Region& region : {anchored, with_feature}) {
        SCOPED_TRACE(mesh.name + ", " + describe(options));
        const Points result =
            make_deformer(scene, region, options).evaluate(std::vector{pose_of(map), pose_of(map)});
        EXPECT_LT(relative_distance(mesh, result, image(mesh.positions, map)), 1e-10);
      }
  }
}

/// Returns the vertices in the middle third of a mesh along its longest side.
std::vector<Index> middle_of(const TestMesh& mesh) {
  const Eigen::RowVector3d low = mesh.positions.colwise().minCoeff(),
                           high = mesh.positions.colwise().maxCoeff();
  int axis = 0;
  (high - low).maxCoeff(&axis);
  std::vector<Index> vertices;
  for (Index v = 0; v < mesh.size(); ++v)
    if (std::abs(mesh.positions(v, axis) - (low[axis] + high[axis]) / 2) < (high[axis] - low[axis]) / 6)
      vertices.push_back(v);
  return vertices;
}

TEST(Methods, SimilarFeaturesStaySimilar) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh, 0.15, 0.12);
    for (const DeformMethod method :
         {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational}) {
      for (const std::optional<double> scale : {std::optional<double>(), std::optional<double>(0.8)}) {
        SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)));
        Region region = held_foot(scene);
        region.features = {{middle_of(mesh), true, scale}};
        ASSERT_GT(region.features[0].vertices.size(), 20U);
        Affine3d stretch = pose_of(head_move(scene)).transform;
        stretch.scale(Vector3d(1.5, 0.8, 1.1));
        EvaluationReport report;
        const Points result = make_deformer(scene, region, options_of(method))
                                  .evaluate(std::vector{pose_of(stretch)}, {}, &report);
        const AffineFit fit = fit_affine(mesh.positions, result, region.features[0].vertices);
        EXPECT_LT(fit.misfit, 1e-10);
        const Matrix3d T = fit.map.linear();
        const double found = std::cbrt(T.determinant());
        EXPECT_LT((T.transpose() * T / (found * found) - Matrix3d::Identity()).norm(), 1e-9);
        EXPECT_NEAR(found, scale.value_or(found), 1e-9);
        EXPECT_LT(report.residual, 1e-8);
      }
    }
  }
}

// Checks that a feature carries its vertices however far it extends. Beyond some rings only the feature's map
// reaches them.
TEST(Methods, FeaturesCarryWhatIsDeepInsideThem) {
  const TestMesh mesh = tube(14, 60);
  const Scene scene = make_scene(mesh, 0.1, 0.05);
  Region region{.whole = true};
  region.handles = {{.name = "foot", .vertices = scene.foot}};
  region.features = {{{}, true, {}}};
  region.features[0].vertices = middle_of(mesh);
  const Affine3d map =
      about_middle(mesh, Matrix3d(0.7 * AngleAxisd(1.9, Vector3d(1, 2, -1).normalized()).toRotationMatrix()));
  const Points result = make_deformer(scene, region, {}).evaluate(std::vector{pose_of(map)});
  EXPECT_LT(relative_distance(mesh, result, image(mesh.positions, map)), 1e-9);
}

TEST(Methods, NothingMovesWhenNothingIsMoved) {
  for (const TestMesh& mesh : mesh_families())
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      EXPECT_TRUE(same_bytes(
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{HandlePose{}}), mesh.positions));
    }
}

TEST(Methods, ASimilarityOfTheSceneCarriesTheResultAlong) {
  for (const TestMesh& mesh : mesh_families()) {
    // Skips scenes at 1e9: moving them away from there changes how their coordinates are rounded.
    if (mesh.positions.cwiseAbs().maxCoeff() > 1e6) continue;
    const double size = mesh.box_diagonal();
    const Affine3d similarity = Eigen::Translation3d(size * Vector3d(2, -1, 3)) *
                                AngleAxisd(1.9, Vector3d(-1, 1, 3).normalized()) * Eigen::Scaling(3.7);
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Scene scene = make_scene(mesh);
      Scene other = scene;
      other.mesh = transformed(mesh, similarity, "");
      const Affine3d move = head_move(scene);
      const Points result =
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(move)});
      const Points other_result = make_deformer(other, held_foot(other), options)
                                      .evaluate(std::vector{pose_of(similarity * move * similarity.inverse())});
      EXPECT_LT(relative_distance(other.mesh, other_result, image(result, similarity)),
                step_tolerance(mesh, options));
    }
  }
}

/// Where every constraint moves, turning the whole mesh at rest does not change the result.
TEST(Methods, ThePoseAtRestDoesNotMatterWhereNothingStays) {
  for (const TestMesh& mesh : {bumpy_sphere(3), tube(14, 30), irregular_grid(22, 16), torus(14, 30)}) {
    const Scene scene = make_scene(mesh);
    const Affine3d pose = about_middle(mesh, Matrix3d(AngleAxisd(2.4, Vector3d(2, -1, 1).normalized())));
    const Affine3d foot_move(Eigen::Translation3d(0.1, 0.2, 0.3)), head = head_move(scene);
    const auto constraints_from = [&](const Affine3d& back) {
      std::vector<VertexConstraint> constraints;
      for (Index v : scene.foot)
        constraints.push_back({v, foot_move * Vector3d(mesh.positions.row(v)), Matrix3d(back.linear())});
      for (Index v : scene.head)
        constraints.push_back(
            {v, head * Vector3d(mesh.positions.row(v)), Matrix3d(head.linear() * back.linear())});
      return constraints;
    };
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const auto evaluate = [&](const TestMesh& posed, const Affine3d& back) {
        const auto constraints = constraints_from(back);
        return Deformer::with_constraints(posed.positions, posed.triangles, {}, constraints, {}, {}, options)
            .evaluate(constraints);
      };
      EXPECT_LT(relative_distance(mesh, evaluate(transformed(mesh, pose, ""), pose.inverse()),
                                  evaluate(mesh, Affine3d::Identity())),
                1e-9);
    }
  }
}

TEST(Methods, OrderDoesNotMatter) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    // Reverses the order of the vertices.
    const Index last = mesh.size() - 1;
    Scene other = scene;
    other.mesh.positions = mesh.positions.colwise().reverse();
    other.mesh.triangles = last - mesh.triangles.array();
    for (auto* end : {&other.foot, &other.head})
      for (Index& v : *end) v = last - v;
    std::reverse(other.head.begin(), other.head.end());
    for (const DeformerOptions& options : method_variants()) {
      SCOPED_TRACE(mesh.name + ", " + describe(options));
      const Affine3d move = head_move(scene);
      const Points expected =
          make_deformer(scene, held_foot(scene), options).evaluate(std::vector{pose_of(move)});
      const Points reversed =
          make_deformer(other, held_foot(other), options).evaluate(std::vector{pose_of(move)});
      const double rounding = eight_ulp(expected) / mesh.box_diagonal();
      EXPECT_LT(relative_distance(mesh, reversed.colwise().reverse(), expected),
                std::max(step_tolerance(mesh, options), rounding));
    }
  }
}

TEST(Methods, HandlesAndVertexConstraintsAreTheSameEdit) {
  const Scene scene = make_scene(bumpy_sphere(3));
  for (const DeformerOptions& options : method_variants()) {
    const Deformer by_handles = make_deformer(scene, two_handles(scene), options);
    const std::vector poses{HandlePose{}, turned(scene, 400)};
    const auto constraints = by_handles.constraints(poses);
    const Deformer by_vertices = Deformer::with_constraints(scene.mesh.positions, scene.mesh.triangles, {},
                                                            constraints, {}, {}, options);
    EXPECT_TRUE(same_bytes(by_vertices.evaluate(constraints), by_handles.evaluate(poses)));
  }
}

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

TEST(Methods, SimilaritiesAreReproducedFromPositionsAlone) {
  for (const TestMesh& mesh : {bumpy_sphere(3), bar(3, 14), tube(14, 30), irregular_grid(22, 16)}) {
    const Scene scene = make_scene(mesh);
    Region region = two_handles(scene);
    for (Handle& handle : region.handles) handle.constrain_transform = false;
    for (const DeformerOptions& options : method_variants())
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + describe(options) + ", " + name);
        const Affine3d map = about_middle(mesh, linear);
        const Points result =
            make_deformer(scene, region, options).evaluate(std::vector{pose_of(map), pose_of(map)});
        EXPECT_LT(relative_distance(mesh, result, image(mesh.positions, map)), 1e-9);
      }
  }
}

/// A second component does not influence the first, however it is constrained.
TEST(Methods, UnrelatedPartsHaveNoSay) {
  const Scene scene = make_scene(tube(10, 16));
  const Index n = scene.mesh.size();
  const TestMesh other =
      transformed(tube(8, 24), Affine3d(Eigen::Translation3d(40, 0, 0) * Eigen::Scaling(3.0)), "");
  TestMesh both = scene.mesh;
  both.positions.conservativeResize(n + other.size(), Eigen::NoChange);
  both.positions.bottomRows(other.size()) = other.positions;
  const auto faces = both.triangles.rows();
  both.triangles.conservativeResize(faces + other.triangles.rows(), Eigen::NoChange);
  both.triangles.bottomRows(other.triangles.rows()) = other.triangles.array() + n;
  Region alone;
  alone.fixed = scene.foot;
  for (Index v = 0; v < n; ++v) alone.vertices.push_back(v);
  alone.handles.push_back(make_handle("head", scene.head));
  Region with_other = alone;
  with_other.whole = true;
  Scene other_scene = make_scene(other);
  for (auto* end : {&other_scene.foot, &other_scene.head}) {
    for (Index& v : *end) v += n;
    with_other.handles.push_back(make_handle("other " + std::to_string(with_other.handles.size()), *end));
    with_other.handles.back().constrain_transform = false;
  }
  for (DeformerOptions options : method_variants()) {
    // With stiffness the components would interact, since its rows are scaled by the area of all free vertices.
    options.stiffness = 0;
    const HandlePose head = turned(scene, 120, Vector3d::UnitX()), still;
    const Points a = Deformer(both.positions, both.triangles, alone, options).evaluate(std::vector{head});
    const Points b =
        Deformer(both.positions, both.triangles, with_other, options).evaluate(std::vector{head, still, still});
    // The co-rotational steps of all components stop together, so their number may differ.
    const double tolerance = options.method == DeformMethod::corotational ? 1e-3 : 1e-9;
    EXPECT_LT(largest_distance(a, b), tolerance * scene.mesh.box_diagonal()) << describe(options);
  }
  const Points stiff =
      Deformer(both.positions, both.triangles, with_other)
          .evaluate(std::vector{turned(scene, 120, Vector3d::UnitX()), HandlePose{}, HandlePose{}});
  EXPECT_LT(largest_distance(stiff.bottomRows(other.size()), other.positions), 1e-9 * other.box_diagonal());
}

/// Checks the methods' main advantage: a bar twisted by 135° keeps its thickness better than by the linear one.
TEST(Methods, LargeTurnsDoNotShrink) {
  const Scene scene = make_scene(bar(6, 36));
  const HandlePose twist = turned(scene, 135, Vector3d::UnitZ());
  const auto quality_of = [&](const DeformerOptions& options) {
    const Deformer deformer = make_deformer(scene, held_foot(scene), options);
    return measure_quality(scene.mesh.positions, deformer.evaluate(std::vector{twist}), scene.mesh.triangles,
                           deformer.free_vertices());
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

TEST(Methods, ReflectionsAndFlatteningsFallBackToLinear) {
  const Scene scene = make_scene(tube(14, 30));
  Matrix3d flat = Matrix3d::Identity();
  flat(2, 2) = 0;
  Matrix3d mirror = Matrix3d::Identity();
  mirror(0, 0) = -1;
  for (const Matrix3d& linear : {flat, mirror}) {
    const std::vector poses{pose_of(about_middle(scene.mesh, linear))};
    const Points expected = make_deformer(scene, held_foot(scene), linear_method()).evaluate(poses);
    for (const DeformMethod method : rotating_methods) {
      EvaluationReport report;
      const Points result =
          make_deformer(scene, held_foot(scene), options_of(method, 0)).evaluate(poses, {}, &report);
      EXPECT_TRUE(report.fell_back_to_linear);
      EXPECT_TRUE(same_bytes(result, expected));
      const Points stiff = make_deformer(scene, held_foot(scene), options_of(method)).evaluate(poses);
      EXPECT_TRUE(stiff.allFinite());
    }
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

TEST(Methods, ResultsDoNotDependOnThreadsOrHistory) {
  const Scene scene = make_scene(irregular_grid(60, 50));
  Context one, two;
  one.threads = 1;
  two.threads = 2;
  const Deformer first(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}, one);
  const Deformer second(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}, two);
  const std::vector move{turned(scene, 100)};
  const Points expected = first.evaluate(move, one);
  EXPECT_TRUE(same_bytes(second.evaluate(move, two), expected));
  second.evaluate(std::vector{turned(scene, 300)}, two);
  EXPECT_TRUE(same_bytes(second.evaluate(move, two), expected));
}

TEST(Methods, ParametersOutOfRangeAreRefused) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const DeformerOptions& options :
       {DeformerOptions{.stiffness = -1}, DeformerOptions{.stiffness = nan}, DeformerOptions{.iterations = -1},
        DeformerOptions{.iterations = 1'000'000}, DeformerOptions{.smoothing_length_rel = nan},
        DeformerOptions{.smoothing_length_rel = -0.1}})
    EXPECT_THROW(make_deformer(scene, held_foot(scene), options), Error);
}

}  // namespace
}  // namespace meshgraft::test
