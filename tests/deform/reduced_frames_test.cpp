// Frames of a reduced model stay near the exact evaluation and obey its laws.
#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"
#include "support/variants.h"

namespace meshgraft::test {
namespace {

using Eigen::Vector3d;

const std::vector<DeformMethod> methods{DeformMethod::corotational, DeformMethod::rotation_aware};

Deformer make_deformer(const Scene& scene, const Region& region, DeformMethod method,
                       DegenerateTreatment treatment = DegenerateTreatment::automatic) {
  DeformerOptions options;
  options.method = method;
  options.operators.degenerate = treatment;
  return {scene.mesh.positions, scene.mesh.triangles, region, options};
}

/// Options of small models, which suffice for laws that hold at every size.
const ReducedFramesOptions few{.centres = 12, .samples_per_centre = 2};

double largest_move(const TestMesh& mesh, const Points& edited) {
  return largest_distance(edited, mesh.positions);
}

TEST(ReducedFrames, AffineMapsAreReproduced) {
  for (const TestMesh& mesh : mesh_families()) {
    const Scene scene = make_scene(mesh);
    for (const DeformMethod method : methods) {
      const Deformer deformer = make_deformer(scene, two_handles(scene), method);
      const ReducedFrames frames(deformer, few);
      for (const auto& [name, linear] : linear_maps()) {
        SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)) + ", " + name);
        const Eigen::Affine3d map = about_middle(mesh, linear);
        const std::vector poses{pose_of(map), pose_of(map)};
        EvaluationReport report;
        const Points frame = frames.frame(poses, {}, &report), exact = deformer.evaluate(poses);
        EXPECT_LE(largest_distance(frame, exact),
                  std::max(1e-6 * std::max(mesh.box_diagonal(), largest_move(mesh, exact)), eight_ulp(exact)));
        EXPECT_EQ(report.fell_back_to_linear, linear.determinant() < 0);
      }
    }
  }
}

TEST(ReducedFrames, AffineMapsAreReproducedFromPositionsAlone) {
  for (const TestMesh& mesh : {bumpy_sphere(3), bar(3, 14), tube(14, 30)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    Region region = two_handles(scene);
    for (Handle& handle : region.handles) handle.constrain_transform = false;
    const Deformer deformer = make_deformer(scene, region, DeformMethod::corotational);
    const ReducedFrames frames(deformer, few);
    for (const auto& [name, linear] : linear_maps()) {
      SCOPED_TRACE(name);
      const Eigen::Affine3d map = about_middle(mesh, linear);
      const std::vector poses{pose_of(map), pose_of(map)};
      const Points exact = deformer.evaluate(poses);
      EXPECT_LE(largest_distance(frames.frame(poses), exact), 1e-6 * largest_move(mesh, exact));
    }
  }
}

TEST(ReducedFrames, NothingMovesWhenNothingIsMoved) {
  for (const TestMesh& mesh : mesh_families())
    for (const DeformMethod method : methods) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)));
      const Scene scene = make_scene(mesh);
      const ReducedFrames frames(make_deformer(scene, held_foot(scene), method), few);
      EXPECT_TRUE(same_bytes(frames.frame(std::vector{HandlePose{}}), mesh.positions));
    }
}

TEST(ReducedFrames, HandlesAndTheOutsideAreExact) {
  for (const TestMesh& mesh : mesh_families()) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const Eigen::Affine3d move = head_move(scene);
    const ReducedFrames frames(make_deformer(scene, held_foot(scene), DeformMethod::corotational), few);
    const Points frame = frames.frame(std::vector{pose_of(move)});
    for (const Index v : scene.foot) EXPECT_EQ(frame.row(v), mesh.positions.row(v));
    for (const Index v : scene.head) EXPECT_EQ(Vector3d(frame.row(v)), move * Vector3d(mesh.positions.row(v)));
  }
}

/// With a centre and a sample at every vertex nothing is interpolated, so the steps equal the exact ones.
TEST(ReducedFrames, WithAllVerticesAsCentresIsTheExactEvaluation) {
  for (const TestMesh& mesh : small_families())
    for (const DeformMethod method : methods)
      for (const bool reflected : {false, true}) {
        SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)) + (reflected ? ", reflected" : ""));
        const Scene scene = make_scene(mesh);
        const Deformer deformer = make_deformer(scene, held_foot(scene), method);
        const ReducedFrames frames(deformer, {.centres = 1000, .samples_per_centre = 1});
        const Eigen::Affine3d mirror(Eigen::Scaling(1.0, -1.0, 1.0));
        const std::vector poses{pose_of(reflected ? head_move(scene) * mirror : head_move(scene))};
        EvaluationReport of_frame, of_exact;
        const Points frame = frames.frame(poses, {}, &of_frame),
                     exact = deformer.evaluate(poses, {}, &of_exact);
        EXPECT_EQ(of_frame.iterations, of_exact.iterations);
        EXPECT_EQ(of_frame.fell_back_to_linear, reflected);
        EXPECT_LE(largest_distance(frame, exact), 1e-5 * largest_move(mesh, exact));
      }
}

/// Returns a turn of the head by any angle about an axis, `pivot_rel` box diagonals below the head's centre.
HandlePose turned(const Scene& scene, const Vector3d& axis, double angle_deg, double pivot_rel = 0) {
  HandleMotion motion;
  motion.axis = axis;
  motion.angle_deg = angle_deg;
  Vector3d centre = Vector3d::Zero();
  for (const Index v : scene.head) centre += scene.mesh.positions.row(v).transpose();
  return make_pose(motion, centre / static_cast<double>(scene.head.size()) -
                               pivot_rel * scene.mesh.box_diagonal() * Vector3d::UnitZ());
}

/// Returns the unit vector along the longest side of the box.
Vector3d longest_side(const TestMesh& mesh) {
  Eigen::Index longest = 0;
  (mesh.positions.colwise().maxCoeff() - mesh.positions.colwise().minCoeff()).maxCoeff(&longest);
  return Vector3d::Unit(longest);
}

TEST(ReducedFrames, EverydayEditsAreWithinHalfAPerCent) {
  for (const TestMesh& mesh : {bar(6, 30), grid(40, 40), irregular_grid(40, 40), tube(24, 48), icosphere(4)}) {
    const Scene scene = make_scene(mesh);
    const Deformer deformer = make_deformer(scene, held_foot(scene), DeformMethod::corotational);
    const ReducedFrames frames(deformer);
    const Vector3d along = longest_side(mesh), across = along.unitOrthogonal();
    const auto shifted = [&](const Vector3d& direction) {
      return pose_of(Eigen::Affine3d(Eigen::Translation3d(0.2 * mesh.box_diagonal() * direction)));
    };
    const std::vector<HandlePose> edits{shifted(across), shifted(along), turned(scene, across, 45),
                                        turned(scene, along, 90)};
    for (std::size_t e = 0; e < edits.size(); ++e) {
      SCOPED_TRACE(mesh.name + ", edit " + std::to_string(e));
      const std::vector poses{edits[e]};
      const Points exact = deformer.evaluate(poses);
      EXPECT_LE(largest_distance(frames.frame(poses), exact), 0.005 * largest_move(mesh, exact));
    }
  }
}

TEST(ReducedFrames, TurnsAreNotReduced) {
  const Scene scene = make_scene(bar(6, 30));
  const Deformer deformer = make_deformer(scene, held_foot(scene), DeformMethod::corotational);
  const ReducedFrames frames(deformer);
  for (const double angle_deg : {270.0, 360.0}) {
    SCOPED_TRACE(angle_deg);
    const std::vector poses{turned(scene, longest_side(scene.mesh), angle_deg)};
    const Points exact = deformer.evaluate(poses), frame = frames.frame(poses);
    EXPECT_LE(largest_distance(frame, exact), 0.005 * largest_move(scene.mesh, exact));
  }
}

/// The distance of a frame from the exact evaluation, relative to the largest displacement, where a disc turns
/// in a bumpy sheet. `place` is the disc's centre, × the diagonal and from the middle of the sheet.
double error_of_turned_disc(const Eigen::RowVector3d& place, DeformMethod method, double angle_deg) {
  const TestMesh mesh = irregular_grid(60, 60);
  const Eigen::RowVector3d middle = mesh.positions.colwise().mean();
  const Eigen::RowVector3d centre = middle + mesh.box_diagonal() * place;
  Region region{.whole = true};
  region.handles.push_back({.name = "disc"});
  for (Index v = 0; v < mesh.size(); ++v) {
    const auto distance = [&](const Eigen::RowVector3d& from) {
      return (mesh.positions.row(v) - from).norm() / mesh.box_diagonal();
    };
    if (distance(centre) < 0.07) region.handles[0].vertices.push_back(v);
    if (distance(middle) > 0.32) region.fixed.push_back(v);
  }
  DeformerOptions options;
  options.method = method;
  const Deformer deformer(mesh.positions, mesh.triangles, region, options);
  HandleMotion motion;
  motion.axis = Vector3d::UnitZ();
  motion.angle_deg = angle_deg;
  const std::vector poses{make_pose(motion, centre.transpose())};
  const Points exact = deformer.evaluate(poses);
  return largest_distance(ReducedFrames(deformer).frame(poses), exact) / largest_move(mesh, exact);
}

TEST(ReducedFrames, ADiscTurnsInABumpySheet) {
  for (const double angle_deg : {45.0, 90.0, -90.0}) {
    EXPECT_LE(error_of_turned_disc({0, 0, 0}, DeformMethod::corotational, angle_deg), 0.02) << angle_deg;
    EXPECT_LE(error_of_turned_disc({0, 0, 0}, DeformMethod::rotation_aware, angle_deg), 0.004) << angle_deg;
  }
}

TEST(ReducedFrames, ADiscTurnsBesideTheMiddleOfABumpySheet) {
  const Eigen::RowVector3d place(0.12, 0.08, 0);
  for (const double angle_deg : {60.0, 90.0, 120.0}) {
    EXPECT_LE(error_of_turned_disc(place, DeformMethod::corotational, angle_deg), 0.05) << angle_deg;
    EXPECT_LE(error_of_turned_disc(place, DeformMethod::rotation_aware, angle_deg), 0.008) << angle_deg;
  }
}

// Most of the limbs' area is that of the thick one, which does not turn.
TEST(ReducedFrames, AThinLimbTurnsBesideAThickOne) {
  const TestMesh thick = tube(40, 40);
  TestMesh thin = thick;
  const Index count = thin.size();
  thin.positions.leftCols<2>() *= 0.1;
  thin.positions.rowwise() += Eigen::RowVector3d(thick.box_diagonal(), 0, 0);
  Points positions(2 * count, 3);
  positions << thin.positions, thick.positions;
  Triangles triangles(thin.triangles.rows() + thick.triangles.rows(), 3);
  triangles << thin.triangles, thick.triangles.array() + count;
  Region region{.whole = true};
  region.handles.push_back({.name = "end"});
  const double low = positions.col(2).minCoeff(), high = positions.col(2).maxCoeff();
  for (Index v = 0; v < positions.rows(); ++v) {
    const double height = (positions(v, 2) - low) / (high - low);
    if (height > 0.9 && v < count) region.handles[0].vertices.push_back(v);
    if (height < 0.1 || (height > 0.9 && v >= count)) region.fixed.push_back(v);
  }
  for (const DeformMethod method : methods) {
    const Deformer deformer(positions, triangles, region, {.method = method});
    HandleMotion motion;
    motion.axis = Vector3d::UnitZ();
    motion.angle_deg = 180;
    const std::vector poses{make_pose(motion, thin.positions.colwise().mean().transpose())};
    const Points exact = deformer.evaluate(poses);
    const double largest_move_of_end = (exact - positions).rowwise().norm().maxCoeff();
    EXPECT_LE(largest_distance(ReducedFrames(deformer).frame(poses), exact), 0.01 * largest_move_of_end)
        << to_string(method);
  }
}

TEST(ReducedFrames, MoreCentresAreNearer) {
  const Scene scene = make_scene(irregular_grid(40, 40));
  const Deformer deformer = make_deformer(scene, held_foot(scene), DeformMethod::corotational);
  const std::vector poses{pose_of(head_move(scene))};
  const Points exact = deformer.evaluate(poses);
  double last = largest_move(scene.mesh, exact);
  for (const Index centres : {8, 32, 128}) {
    const double error = largest_distance(ReducedFrames(deformer, {.centres = centres}).frame(poses), exact);
    EXPECT_LT(error, last / 1.5) << centres;
    last = error;
  }
}

TEST(ReducedFrames, FollowsAnchorsAndTheOtherTreatment) {
  for (const DegenerateTreatment treatment : {DegenerateTreatment::apex, DegenerateTreatment::ft05_noise}) {
    SCOPED_TRACE(to_string(treatment));
    const Scene scene = make_scene(bumpy_sphere(3));
    Region region = held_foot(scene);
    for (Index v = 0; v < scene.mesh.size(); v += 9)
      region.anchors.push_back({v, 300, scene.mesh.positions.row(v).transpose() + Vector3d(0, 0.1, 0)});
    const Deformer deformer = make_deformer(scene, region, DeformMethod::corotational, treatment);
    const ReducedFrames frames(deformer);
    for (const HandlePose& pose : {HandlePose{}, turned(scene, Vector3d::UnitX(), 30)}) {
      const Points exact = deformer.evaluate(std::vector{pose});
      const double error = largest_distance(frames.frame(std::vector{pose}), exact);
      EXPECT_GT(largest_move(scene.mesh, exact), 0.01);
      EXPECT_LE(error, 0.041 * largest_move(scene.mesh, exact));
    }
  }
}

TEST(ReducedFrames, EveryPartHasACentre) {
  // Uses three separate bars and asks for one centre. Positions alone hold the second and the third bar.
  const Scene one = make_scene(bar(2, 8));
  const Index n = one.mesh.size();
  Scene scene;
  scene.mesh.positions.resize(3 * n, 3);
  scene.mesh.triangles.resize(3 * one.mesh.triangles.rows(), 3);
  Region region;
  region.whole = true;
  for (Index part = 0; part < 3; ++part) {
    scene.mesh.positions.middleRows(part * n, n) =
        one.mesh.positions.rowwise() + 10.0 * static_cast<double>(part) * Eigen::RowVector3d::UnitY();
    scene.mesh.triangles.middleRows(part * one.mesh.triangles.rows(), one.mesh.triangles.rows()) =
        one.mesh.triangles.array() + part * n;
    std::vector<Index> ends;
    for (const auto* end : {&one.foot, &one.head})
      for (const Index v : *end) ends.push_back(v + part * n);
    region.handles.push_back(make_handle("ends " + std::to_string(part), ends));
    region.handles.back().constrain_transform = part == 0;
  }
  const Deformer deformer = make_deformer(scene, region, DeformMethod::corotational);
  const ReducedFrames frames(deformer, {.centres = 1, .samples_per_centre = 1});
  EXPECT_GE(frames.centres(), 2);
  std::vector<HandlePose> poses;
  for (int part = 0; part < 3; ++part)
    poses.push_back(pose_of(Eigen::Translation3d(part, 1, 0) *
                            Eigen::Affine3d(Eigen::AngleAxisd(0.5 + part, Vector3d(1, 2, part).normalized()))));
  const Points frame = frames.frame(poses);
  for (Index v = 0; v < 3 * n; ++v)
    EXPECT_LT((Vector3d(frame.row(v)) - poses[v / n].transform * Vector3d(scene.mesh.positions.row(v))).norm(),
              1e-5);
}

TEST(ReducedFrames, SameBytesForAnyNumberOfThreads) {
  for (const TestMesh& mesh : {bumpy_sphere(4), irregular_grid(60, 50)}) {
    SCOPED_TRACE(mesh.name);
    const Scene scene = make_scene(mesh);
    const auto frame = [&](int threads) {
      Context context;
      context.threads = threads;
      const Deformer deformer(mesh.positions, mesh.triangles, held_foot(scene), {}, context);
      return ReducedFrames(deformer, {.centres = 40}, context)
          .frame(std::vector{pose_of(head_move(scene))}, context);
    };
    EXPECT_TRUE(same_bytes(frame(1), frame(2)));
  }
}

std::string id_of(const std::function<void()>& body) {
  try {
    body();
  } catch (const Error& error) {
    EXPECT_FALSE(error.problem().empty());
    return std::string(error.id());
  }
  return "nothing was thrown";
}

TEST(ReducedFrames, RefusesWhatItDoesNotCover) {
  const Scene scene = make_scene(bumpy_sphere(2));
  const TestMesh& mesh = scene.mesh;
  const auto reduce = [](const Deformer& deformer, const ReducedFramesOptions& options = few) {
    ReducedFrames frames(deformer, options);
  };
  EXPECT_EQ(id_of([&] { reduce(make_deformer(scene, held_foot(scene), DeformMethod::ft05)); }),
            "deform.reduced_frames_needless");
  const std::vector<VertexConstraint> constraints{
      {.vertex = 0, .position = Vector3d::Zero(), .transform = Eigen::Matrix3d::Identity()}};
  const Deformer per_vertex({mesh.positions, mesh.triangles, {.whole = true}, constraints});
  EXPECT_EQ(id_of([&] { reduce(per_vertex); }), "deform.no_handles");
  Region region = held_foot(scene);
  std::vector<char> held(static_cast<std::size_t>(mesh.size()), 0);
  for (const auto* end : {&scene.foot, &scene.head})
    for (const Index v : *end) held[v] = 1;
  region.features.push_back(
      {{static_cast<Index>(std::find(held.begin(), held.end(), 0) - held.begin())}, false, {}});
  EXPECT_EQ(id_of([&] { reduce(make_deformer(scene, region, DeformMethod::corotational)); }),
            "deform.features_not_reduced");

  const Deformer deformer = make_deformer(scene, held_foot(scene), DeformMethod::corotational);
  EXPECT_EQ(id_of([&] { reduce(deformer, {.centres = 0}); }), "core.out_of_range");
  EXPECT_EQ(id_of([&] { reduce(deformer, {.samples_per_centre = 65}); }), "core.out_of_range");
  const ReducedFrames frames(deformer, few);
  Points positions(mesh.size(), 3), small(3, 3);
  const std::vector rest{HandlePose{}};
  EXPECT_EQ(id_of([&] { frames.frame({}, positions); }), "core.size_mismatch");
  EXPECT_EQ(id_of([&] { frames.frame(rest, small); }), "core.size_mismatch");
  HandlePose redrawn, broken;
  redrawn.curve = Points::Zero(static_cast<Eigen::Index>(scene.head.size()), 3);
  broken.transform.linear()(1, 2) = std::nan("");
  EXPECT_EQ(id_of([&] { frames.frame(std::vector{redrawn}, positions); }), "deform.curve_not_affine");
  EXPECT_EQ(id_of([&] { frames.frame(std::vector{broken}, positions); }), "deform.too_large_or_not_finite");
}

TEST(ReducedFrames, CanBeCancelled) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const Deformer deformer = make_deformer(scene, held_foot(scene), DeformMethod::corotational);
  std::stop_source stop;
  stop.request_stop();
  Context context;
  context.stop_token = stop.get_token();
  EXPECT_EQ(id_of([&] { ReducedFrames frames(deformer, few, context); }), "core.cancelled");
}

}  // namespace
}  // namespace meshgraft::test
