// A live deformation refuses wrong input at once, and reports each later failure with its pose.
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "live_recorder.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

TEST(LiveDeformer, ReportsWhatTheDeformerReports) {
  const Scene scene = make_scene(bumpy_sphere(3));
  Region loose = held_foot(scene);  // constrained by one position only
  loose.fixed.clear();
  loose.handles[0].vertices = {scene.head.front()};
  loose.handles[0].constrain_transform = false;
  const auto expected = error_of([&] { make_direct(scene, loose, DeformMethod::corotational); });
  ASSERT_EQ(expected.first, "deform.component_held_by_positions");
  Recorder recorder;
  LiveDeformer live = make_live(scene, loose, recorder, quick_options(DeformMethod::corotational));
  live.drag(std::vector{HandlePose{}});
  EXPECT_EQ(error_of([&] { live.wait_until_exact(); }), expected);
  recorder.wait_for_failure();
  EXPECT_EQ(live.stage(), LiveStage::failed);
  EXPECT_EQ(live.drag(std::vector{HandlePose{}}), 2);
  EXPECT_EQ(error_of([&] { live.wait_until_exact(); }), expected);
  live.close();
  ASSERT_EQ(recorder.failures().size(), 1U);
  EXPECT_EQ(recorder.failures()[0].pose, 0);
  EXPECT_EQ(recorder.failures()[0].error.what(), expected.second);
}

TEST(LiveDeformer, TheConstructorThrowsWhatIsWrongAtFirstSight) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const auto same_error = [&](const Region& region, const DeformerOptions& options = {}) {
    Recorder recorder;
    LiveOptions live;
    live.deformer = options;
    EXPECT_EQ(error_of([&] { make_live(scene, region, recorder, live); }),
              error_of([&] { Deformer(scene.mesh.positions, scene.mesh.triangles, region, options); }));
  };
  std::vector<Region> wrong(4, held_foot(scene));
  wrong[0].handles[0].vertices.clear();
  wrong[1].handles.push_back(wrong[1].handles[0]);
  wrong[2].fixed.push_back(scene.mesh.size());
  wrong[3].anchors.push_back({.vertex = 1, .weight = -1});
  for (const Region& region : wrong) same_error(region);
  same_error(held_foot(scene), {.stiffness = -1});
  same_error(held_foot(scene), {.operators = {.apex_height_rel = -1}});
  std::vector<LiveOptions> odd(3);
  odd[0].reduced.centres = 0;
  odd[1].proxy_vertices = 0;
  odd[2].settle_seconds = std::nan("");
  const std::array ids{"core.out_of_range", "deform.proxy_without_vertices", "core.out_of_range"};
  for (std::size_t o = 0; o < odd.size(); ++o) {
    Recorder recorder;
    EXPECT_EQ(error_of([&] { make_live(scene, held_foot(scene), recorder, odd[o]); }).first, ids[o]);
  }
  EXPECT_EQ(
      error_of([&] { LiveDeformer({scene.mesh.positions, scene.mesh.triangles, held_foot(scene)}, {}); }).first,
      "deform.no_frame_callback");
  Recorder recorder;
  LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::ft05));
  EXPECT_EQ(error_of([&] { live.drag({}); }).first, "core.size_mismatch");
  HandlePose endless;
  endless.transform.translation().x() = std::nan("");
  EXPECT_EQ(error_of([&] { live.drag(std::vector{endless}); }).first, "deform.too_large_or_not_finite");
}

/// A pose that cannot be evaluated is reported once with its number, and the next pose is evaluated.
TEST(LiveDeformer, APoseThatCannotBeEvaluatedIsToldOnce) {
  const Scene scene = make_scene(bumpy_sphere(3));
  Recorder recorder;
  LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::ft05));
  HandlePose redrawn;  // the handle is no curve
  redrawn.curve = Points::Zero(2, 3);
  live.drag(std::vector{redrawn});
  const auto told = error_of([&] { live.wait_until_exact(); });
  recorder.wait_for_failure();
  live.drag(part_of_move(scene, 1));
  live.wait_until_exact();
  ASSERT_EQ(recorder.failures().size(), 1U);
  EXPECT_EQ(recorder.failures()[0].pose, 1);
  EXPECT_EQ(recorder.failures()[0].error.id(), told.first);
  EXPECT_EQ(recorder.frames().back().pose, 2);
}

/// If only the proxy cannot be made, exact frames still come.
TEST(LiveDeformer, WorksWhereOnlyAProxyFails) {
  // One vertex is not finite. It lies in the proxy domain, which is wider, but beyond the solve's reach.
  Scene scene = make_scene(grid(60, 60));
  Region region;
  const Eigen::RowVector3d middle = scene.mesh.positions.colwise().mean();
  Index farthest = 0;
  for (Index v = 0; v < scene.mesh.size(); ++v) {
    const auto from_middle = [&](Index u) { return (scene.mesh.positions.row(u) - middle).norm(); };
    if (from_middle(v) > from_middle(farthest)) farthest = v;
    if (from_middle(v) < 0.2 * scene.mesh.box_diagonal()) region.vertices.push_back(v);
  }
  region.handles.push_back({.name = "top", .vertices = {region.vertices[region.vertices.size() / 2]}});
  scene.mesh.positions.row(farthest).setConstant(std::numeric_limits<double>::quiet_NaN());
  const LiveOptions options = quick_options(DeformMethod::ft05);
  const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, region, options.deformer);
  Recorder recorder;
  LiveDeformer live = make_live(scene, region, recorder, options);
  live.drag(std::vector{HandlePose{}});
  live.wait_until_exact();
  EXPECT_TRUE(same_bytes(*recorder.frames().back().positions, deformer.evaluate(std::vector{HandlePose{}})));
}

TEST(LiveDeformer, RefusesPosesThatAreNoNumbers) {
  const Scene scene = make_scene(bumpy_sphere(3));
  Recorder recorder;
  LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::ft05));
  std::vector<HandlePose> wrong(3);
  wrong[0].rotation = Eigen::AngleAxisd(std::numeric_limits<double>::quiet_NaN(), Eigen::Vector3d::UnitZ());
  wrong[1].transform.translation().setConstant(1e101);
  wrong[2].transform.linear()(0, 1) = std::numeric_limits<double>::infinity();
  const std::array ids{"core.not_finite", "deform.too_large_or_not_finite", "deform.too_large_or_not_finite"};
  for (std::size_t p = 0; p < wrong.size(); ++p)
    EXPECT_EQ(error_of([&] { live.drag(std::vector{wrong[p]}); }).first, ids[p]);
}

TEST(LiveDeformer, ProgressMayFailOrAskWithoutAHang) {
  const Scene scene = make_scene(bumpy_sphere(3));
  const auto outcome = [&](const ProgressCallback& progress) {
    Recorder recorder;
    LiveDeformer live({scene.mesh.positions, scene.mesh.triangles, held_foot(scene)}, recorder.callbacks(),
                      quick_options(DeformMethod::ft05),
                      {.threads = 0, .progress = progress, .stop_token = {}});
    live.drag(std::vector{HandlePose{}});
    return error_of([&] { live.wait_until_exact(); }).first;
  };
  static constexpr FactType by_callback{"test.cancelled", ErrorCode::cancelled, {}, "by the callback", ""};
  EXPECT_EQ(outcome([](const Progress&) { throw Error(Fact(by_callback, {})); }), by_callback.id);
  EXPECT_EQ(outcome([](const Progress&) { throw std::runtime_error("broken"); }), "core.bug");
}

TEST(LiveDeformer, TheProxyStaysWhereTheRestDoesNotFit) {
  const Scene scene = make_scene(bumpy_sphere(3));
  LiveOptions options = quick_options(DeformMethod::corotational);
  Context context;
  context.progress = [](const Progress& progress) {  // simulates an exact set-up that runs out of memory
    if (progress.stage == "assemble" && progress.within.empty()) throw std::bad_alloc();
  };
  Recorder recorder;
  LiveDeformer live = make_live(scene, held_foot(scene), recorder, options, context);
  live.drag(part_of_move(scene, 1));
  recorder.wait_for_failure();
  EXPECT_EQ(recorder.failures()[0].pose, 0);
  EXPECT_EQ(recorder.failures()[0].error.code(), ErrorCode::memory);
  EXPECT_EQ(live.stage(), LiveStage::proxy_only);
  EXPECT_EQ(error_of([&] { live.wait_until_exact(); }).first, "core.out_of_memory");
  live.drag(part_of_move(scene, 0.5));
  recorder.wait_for_frames(1);
  for (const LiveFrame& frame : recorder.frames()) EXPECT_EQ(frame.accuracy, FrameAccuracy::proxy);
}

}  // namespace
}  // namespace meshgraft::test
