// A live deformation drops superseded poses, never shows a worse frame, and ends at the exact evaluation.
#include <algorithm>
#include <cmath>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "live_recorder.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

TEST(LiveDeformer, EndsAtTheExactEvaluationOfTheLastPose) {
  for (const TestMesh& mesh : some_families())
    for (const DeformMethod method : methods) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)));
      const Scene scene = make_scene(mesh);
      Recorder recorder;
      LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(method));
      const int burst = 30;
      for (int i = 1; i <= burst; ++i) {
        EXPECT_EQ(live.drag(part_of_move(scene, static_cast<double>(i) / burst)), i);
        if (i % 7 == 0) std::this_thread::yield();
      }
      live.wait_until_exact();
      const LiveFrame last = recorder.frames().back();
      EXPECT_EQ(last.pose, burst);
      EXPECT_EQ(last.accuracy, FrameAccuracy::exact);
      EXPECT_EQ(last.error_rel, 0.0);
      EXPECT_TRUE(same_bytes(*last.positions,
                             make_direct(scene, held_foot(scene), method).evaluate(part_of_move(scene, 1))));
      recorder.expect_order();
      EXPECT_EQ(recorder.poses_with_frames() + live.superseded(), burst);
      EXPECT_TRUE(recorder.failures().empty());
    }
}

TEST(LiveDeformer, GoesOnFromAnEarlierDeformer) {
  for (const TestMesh& mesh : some_families())
    for (const DeformMethod method : methods) {
      SCOPED_TRACE(mesh.name + ", " + std::string(to_string(method)));
      const Scene scene = make_scene(mesh);
      const Region region = held_foot(scene);
      Region more = region;  // fixes one vertex that was free
      const Deformer direct = make_direct(scene, region, method);
      more.fixed.push_back(direct.free_vertices().front());
      Recorder recorder, again;
      LiveOptions options = quick_options(method);
      LiveDeformer first = make_live(scene, region, recorder, options);
      EXPECT_FALSE(first.deformer() && first.deformer()->summary().reused);
      first.wait_until_exact();
      options.earlier = first.deformer();
      LiveDeformer second = make_live(scene, more, again, options);
      const std::weak_ptr<const Deformer> earlier = std::exchange(options.earlier, nullptr);
      second.drag(part_of_move(scene, 1));
      second.wait_until_exact();
      EXPECT_TRUE(second.deformer()->summary().reused);
      const Points expected = make_direct(scene, more, method).evaluate(part_of_move(scene, 1));
      EXPECT_LT((*again.frames().back().positions - expected).rowwise().norm().maxCoeff(),
                1e-9 * mesh.box_diagonal());
      EXPECT_EQ(earlier.use_count(), 1) << "the first one's own";
    }
}

/// Checks that the newest pose waits for the first stage of the set-up, and is refined as later ones come.
TEST(LiveDeformer, GetsBetterByItself) {
  const Scene scene = make_scene(bumpy_sphere(3));
  for (const DeformMethod method : methods) {
    SCOPED_TRACE(to_string(method));
    Recorder recorder;
    Context context;
    context.progress = [&](const Progress& progress) {  // the deformer waits for the proxy's frame
      if (progress.stage == "assemble" && progress.within.empty()) recorder.wait_for_frames(1);
    };
    LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(method), context);
    live.drag(part_of_move(scene, 1));
    live.wait_until_exact();
    while (live.stage() != LiveStage::ready) std::this_thread::yield();
    const std::size_t before = recorder.frames().size();
    EXPECT_EQ(recorder.frames().front().accuracy, FrameAccuracy::proxy);
    // Drags twice, since the second preview reports the error of the first.
    for (const double part : {0.6, 0.7}) {
      live.drag(part_of_move(scene, part));
      live.wait_until_exact();
    }
    const std::vector<LiveFrame> frames = recorder.frames();
    ASSERT_EQ(frames.size(), before + 4);
    const FrameAccuracy quick = method == DeformMethod::ft05 ? FrameAccuracy::linear : FrameAccuracy::reduced;
    EXPECT_EQ(frames[before].accuracy, quick);
    EXPECT_EQ(frames[before + 1].accuracy, FrameAccuracy::exact);
    ASSERT_TRUE(frames[before + 2].error_rel.has_value());
    EXPECT_LE(*frames[before + 2].error_rel, method == DeformMethod::ft05 ? 1e-9 : 0.32);
    EXPECT_EQ(live.basis() != nullptr, method == DeformMethod::ft05);
    recorder.expect_order();
  }
}

TEST(LiveDeformer, EachFrameIsWhatItsAccuracySays) {
  const Scene scene = make_scene(irregular_grid(20, 20));
  const LiveOptions options = quick_options(DeformMethod::corotational);
  Recorder recorder;
  LiveDeformer live = make_live(scene, held_foot(scene), recorder, options);
  for (int i = 0; i < 3; ++i) {
    live.drag(part_of_move(scene, 1));
    live.wait_until_exact();
    while (i == 0 && live.stage() != LiveStage::ready) std::this_thread::yield();
  }
  const Deformer direct = make_direct(scene, held_foot(scene), DeformMethod::corotational);
  const ReducedFrames reduced(direct, options.reduced);
  const ProxyDeformer proxy(scene.mesh.positions, scene.mesh.triangles, held_foot(scene),
                            {options.deformer, options.proxy_vertices});
  const std::vector<HandlePose> poses = part_of_move(scene, 1);
  for (const LiveFrame& frame : recorder.frames()) {
    SCOPED_TRACE(to_string(frame.accuracy));
    EXPECT_GE(frame.seconds, 0);
    const Points expected = frame.accuracy == FrameAccuracy::proxy     ? proxy.evaluate(poses)
                            : frame.accuracy == FrameAccuracy::reduced ? reduced.frame(poses)
                                                                       : direct.evaluate(poses);
    EXPECT_TRUE(same_bytes(*frame.positions, expected));
  }
}

TEST(LiveDeformer, DropsPosesThatAreSuperseded) {
  const Scene scene = make_scene(bumpy_sphere(3));
  Recorder recorder;
  // The gate holds the set-up back, so that every pose but the last is superseded.
  std::mutex gate;
  std::unique_lock closed_gate(gate);
  Context context;
  context.progress = [&](const Progress&) { const std::lock_guard pass(gate); };
  LiveDeformer live =
      make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::corotational), context);
  for (int i = 1; i <= 10; ++i) live.drag(part_of_move(scene, 0.1 * i));
  EXPECT_EQ(live.superseded(), 9);
  EXPECT_EQ(live.stage(), LiveStage::starting);
  closed_gate.unlock();
  live.wait_until_exact();
  EXPECT_EQ(live.superseded(), 9);
  for (const LiveFrame& frame : recorder.frames()) EXPECT_EQ(frame.pose, 10);
}

/// Without previews, poses are evaluated exactly one after another, so that an endless drag still shows frames.
TEST(LiveDeformer, ShowsExactFramesWhereNothingIsQuicker) {
  const Scene scene = make_scene(bumpy_sphere(3));
  Region region = held_foot(scene);
  const std::vector<Index>& foot = scene.foot;
  Feature feature;
  for (Index v = 0; v < scene.mesh.size() && feature.vertices.size() < 8; ++v)
    if (std::find(foot.begin(), foot.end(), v) == foot.end() &&
        std::find(scene.head.begin(), scene.head.end(), v) == scene.head.end())
      feature.vertices.push_back(v);
  region.features = {feature};
  LiveOptions options = quick_options(DeformMethod::corotational);
  options.proxy_from = 1'000'000;
  Recorder recorder;
  LiveDeformer live = make_live(scene, region, recorder, options);
  while (live.stage() != LiveStage::ready) std::this_thread::yield();
  int dragged = 0;
  while (recorder.frames().size() < 3) {
    live.drag(part_of_move(scene, 0.5 + 0.4 * std::sin(++dragged)));
    std::this_thread::yield();
  }
  live.drag(part_of_move(scene, 1));
  live.wait_until_exact();
  for (const LiveFrame& frame : recorder.frames()) EXPECT_EQ(frame.accuracy, FrameAccuracy::exact);
  recorder.expect_order();
  EXPECT_TRUE(
      same_bytes(*recorder.frames().back().positions,
                 make_direct(scene, region, DeformMethod::corotational).evaluate(part_of_move(scene, 1))));
}

TEST(LiveDeformer, FollowsRedrawnCurves) {
  const Scene scene = make_scene(grid(20, 20));
  Region region;
  region.whole = true;
  region.fixed = scene.foot;
  Handle curve;
  curve.name = "curve";
  curve.shape = HandleShape::curve;
  for (Index v = 0; v <= 20; ++v) curve.vertices.push_back(21 * 10 + v);
  std::erase_if(curve.vertices, [&](Index v) {
    return std::find(scene.foot.begin(), scene.foot.end(), v) != scene.foot.end();
  });
  region.handles = {curve};
  Points redrawn(static_cast<Eigen::Index>(curve.vertices.size()), 3);
  for (Eigen::Index k = 0; k < redrawn.rows(); ++k)
    redrawn.row(k) = scene.mesh.positions.row(curve.vertices[static_cast<std::size_t>(k)]) +
                     Eigen::RowVector3d(0, 0, 0.01 * static_cast<double>(k));
  HandlePose pose;
  pose.curve = redrawn;
  const std::vector<HandlePose> poses{pose};
  for (const DeformMethod method : methods) {
    SCOPED_TRACE(to_string(method));
    Recorder recorder;
    LiveDeformer live = make_live(scene, region, recorder, quick_options(method));
    while (live.stage() != LiveStage::ready) std::this_thread::yield();
    live.drag(poses);
    live.wait_until_exact();
    const std::vector<LiveFrame> frames = recorder.frames();
    ASSERT_EQ(frames.size(), 2U);
    EXPECT_EQ(frames[0].accuracy, FrameAccuracy::proxy);
    EXPECT_TRUE(same_bytes(*frames[1].positions, make_direct(scene, region, method).evaluate(poses)));
  }
}

TEST(LiveDeformer, TellsItsProgress) {
  const Scene scene = make_scene(bumpy_sphere(3));
  std::set<std::pair<std::string, std::string>> told;  // tasks and their stages
  Context context;
  context.progress = [&](const Progress& progress) {
    EXPECT_LE(progress.fraction, 1);
    EXPECT_EQ(progress.count, 0);
    told.emplace(progress.within, progress.stage);
  };
  Recorder recorder;
  {
    LiveDeformer live =
        make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::corotational), context);
    live.wait_until_exact();  // without a pose, this waits for the deformer
    EXPECT_GE(live.stage(), LiveStage::exact);
    while (live.stage() != LiveStage::ready) std::this_thread::yield();
  }
  EXPECT_TRUE(recorder.frames().empty());
  for (const char* stage : {"decimate", "factorise"}) EXPECT_TRUE(told.contains({"proxy", stage})) << stage;
  for (const char* stage : {"assemble", "factorise", "reduce"})
    EXPECT_TRUE(told.contains({"", stage})) << stage;
}

TEST(LiveDeformer, TakesAMeshWithoutVertices) {
  Recorder recorder;
  LiveDeformer live({Points(0, 3), Triangles(0, 3), {.whole = true}}, recorder.callbacks(),
                    quick_options(DeformMethod::corotational));
  live.drag({});
  live.wait_until_exact();
  EXPECT_EQ(recorder.frames().back().positions->rows(), 0);
}

}  // namespace
}  // namespace meshgraft::test
