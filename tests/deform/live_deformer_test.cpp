// A live deformation drops superseded poses, never shows a worse frame, and ends at the exact evaluation.
#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <filesystem>
#include <limits>
#include <memory>
#include <mutex>
#include <new>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/deform/proxy.h>
#include <meshgraft/deform/reduced_frames.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

const std::vector<DeformMethod> methods{DeformMethod::ft05, DeformMethod::rotation_aware,
                                        DeformMethod::corotational};

/// Returns options for tests: small models, no pause before the exact evaluation, and a proxy at any size.
LiveOptions quick_options(DeformMethod method) {
  LiveOptions options;
  options.deformer.method = method;
  options.reduced = {.centres = 12, .samples_per_centre = 2};
  options.proxy_from = 1;
  options.proxy_vertices = 60;
  options.settle_seconds = 0;
  return options;
}

/// Records frames and failures, with a copy of each frame's positions at its arrival.
class Recorder {
 public:
  struct Failure {
    std::int64_t pose;
    Error error;
  };

  LiveCallbacks callbacks() {
    return {[this](const LiveFrame& frame) {
              const Alone alone(*this);
              copies_.push_back(*frame.positions);
              frames_.push_back(frame);
              arrived_.notify_all();
            },
            [this](std::int64_t pose, const Error& error) {
              const Alone alone(*this);
              failures_.push_back({pose, error});
              arrived_.notify_all();
            }};
  }
  std::vector<LiveFrame> frames() const {
    const std::lock_guard lock(mutex_);
    return frames_;
  }
  std::vector<Failure> failures() const {
    const std::lock_guard lock(mutex_);
    return failures_;
  }
  void wait_for_failure() const {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [this] { return !failures_.empty(); });
  }
  void wait_for_frames(std::size_t count) const {
    std::unique_lock lock(mutex_);
    arrived_.wait(lock, [&] { return frames_.size() >= count; });
  }

  /// Checks that poses come in order, that each pose's qualities rise, and that no frame changed later.
  void expect_order() const {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(overlapped_);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      EXPECT_TRUE(same_bytes(*frames_[i].positions, copies_[i]));
      if (i == 0) continue;
      const LiveFrame &before = frames_[i - 1], &after = frames_[i];
      EXPECT_LE(before.pose, after.pose);
      EXPECT_TRUE(before.pose < after.pose || before.quality < after.quality);
    }
  }
  std::int64_t poses_with_frames() const {
    const std::lock_guard lock(mutex_);
    std::int64_t count = 0;
    for (std::size_t i = 0; i < frames_.size(); ++i) count += i == 0 || frames_[i - 1].pose != frames_[i].pose;
    return count;
  }

 private:
  /// Detects whether two callbacks run at the same time.
  class Alone {
   public:
    explicit Alone(Recorder& recorder) : recorder_(recorder) {
      if (recorder_.inside_.fetch_add(1) != 0) recorder_.overlapped_ = true;
      recorder_.mutex_.lock();
    }
    ~Alone() {
      recorder_.mutex_.unlock();
      recorder_.inside_.fetch_sub(1);
    }
    Alone(const Alone&) = delete;
    Alone& operator=(const Alone&) = delete;

   private:
    Recorder& recorder_;
  };

  mutable std::mutex mutex_;
  mutable std::condition_variable arrived_;
  std::vector<LiveFrame> frames_;
  std::vector<Points> copies_;
  std::vector<Failure> failures_;
  std::atomic<int> inside_ = 0;
  std::atomic<bool> overlapped_ = false;
};

LiveDeformer make_live(const Scene& scene, const Region& region, Recorder& recorder, const LiveOptions& options,
                       const Context& context = {}) {
  return {scene.mesh.positions, scene.mesh.triangles, region, recorder.callbacks(), options, context};
}

Deformer make_direct(const Scene& scene, const Region& region, DeformMethod method) {
  DeformerOptions options;
  options.method = method;
  return {scene.mesh.positions, scene.mesh.triangles, region, options};
}

/// Returns a pose between rest (`part` 0) and the head's move (`part` 1).
std::vector<HandlePose> part_of_move(const Scene& scene, double part) {
  HandlePose pose = pose_of(head_move(scene));
  pose.transform.matrix() = (1 - part) * Eigen::Matrix4d::Identity() + part * pose.transform.matrix();
  return {pose};
}

template <class Call>
std::pair<std::string, std::string> error_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return {std::string(error.id()), error.what()};
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

std::vector<TestMesh> some_families() {
  return {bumpy_sphere(3), irregular_grid(20, 20), bar(3, 14), torus(20, 12)};
}

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
      EXPECT_EQ(last.quality, FrameQuality::exact);
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
    context.progress = [&](std::string_view step, double) {  // the deformer waits for the proxy's frame
      if (step == "assemble") recorder.wait_for_frames(1);
    };
    LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(method), context);
    live.drag(part_of_move(scene, 1));
    live.wait_until_exact();
    while (live.stage() != LiveStage::ready) std::this_thread::yield();
    const std::size_t before = recorder.frames().size();
    EXPECT_EQ(recorder.frames().front().quality, FrameQuality::proxy);
    // Drags twice, since the second preview reports the error of the first.
    for (const double part : {0.6, 0.7}) {
      live.drag(part_of_move(scene, part));
      live.wait_until_exact();
    }
    const std::vector<LiveFrame> frames = recorder.frames();
    ASSERT_EQ(frames.size(), before + 4);
    const FrameQuality quick = method == DeformMethod::ft05 ? FrameQuality::linear : FrameQuality::reduced;
    EXPECT_EQ(frames[before].quality, quick);
    EXPECT_EQ(frames[before + 1].quality, FrameQuality::exact);
    ASSERT_TRUE(frames[before + 2].error_rel.has_value());
    EXPECT_LE(*frames[before + 2].error_rel, method == DeformMethod::ft05 ? 1e-9 : 0.2);
    EXPECT_EQ(live.basis() != nullptr, method == DeformMethod::ft05);
    recorder.expect_order();
  }
}

TEST(LiveDeformer, EachFrameIsWhatItsQualitySays) {
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
    SCOPED_TRACE(to_string(frame.quality));
    EXPECT_GE(frame.seconds, 0);
    const Points expected = frame.quality == FrameQuality::proxy     ? proxy.evaluate(poses)
                            : frame.quality == FrameQuality::reduced ? reduced.frame(poses)
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
  context.progress = [&](std::string_view, double) { const std::lock_guard pass(gate); };
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
  for (const LiveFrame& frame : recorder.frames()) EXPECT_EQ(frame.quality, FrameQuality::exact);
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
    EXPECT_EQ(frames[0].quality, FrameQuality::proxy);
    EXPECT_TRUE(same_bytes(*frames[1].positions, make_direct(scene, region, method).evaluate(poses)));
  }
}

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
      error_of([&] { LiveDeformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}); }).first,
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

TEST(LiveDeformer, TellsItsProgress) {
  const Scene scene = make_scene(bumpy_sphere(3));
  std::vector<std::string> steps;
  Context context;
  context.progress = [&](std::string_view step, double fraction) {
    EXPECT_LE(fraction, 1);
    if (steps.empty() || steps.back() != step) steps.emplace_back(step);
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
  for (const char* expected : {"proxy: decimate", "proxy: factorise", "assemble", "factorise", "reduce"})
    EXPECT_NE(std::find(steps.begin(), steps.end(), expected), steps.end()) << expected;
}

std::size_t thread_count() {
  std::size_t count = 0;
  for ([[maybe_unused]] const auto& task : std::filesystem::directory_iterator("/proc/self/task")) ++count;
  return count;
}

/// Destroys the object at random moments of the set-up and later. No frame may follow, no thread may be left,
/// and kept frames must stay valid.
TEST(LiveDeformer, CanBeDestroyedAtAnyMoment) {
  using Clock = std::chrono::steady_clock;
  const Scene scene = make_scene(bumpy_sphere(2));
  std::mt19937 random(1);
  std::vector<LiveFrame> kept;
  std::size_t threads = 0;
  for (const DeformMethod method : methods) {
    SCOPED_TRACE(to_string(method));
    Clock::duration whole{};
    for (int time = 0; time < 16; ++time) {
      Recorder recorder;
      std::weak_ptr<const HandleBasis> basis;
      {
        const Clock::time_point start = Clock::now();
        LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(method));
        live.drag(part_of_move(scene, 1));
        if (time == 0) {
          while (live.stage() != LiveStage::ready) std::this_thread::yield();
          live.wait_until_exact();
          whole = Clock::now() - start;
        }
        const Clock::time_point end = start + whole / 100 * (random() % 110);
        for (int i = 0; Clock::now() < end; ++i) {
          live.drag(part_of_move(scene, 0.05 * i));
          std::this_thread::sleep_for(whole / 20);
        }
        basis = live.basis();
      }
      const std::vector<LiveFrame> frames = recorder.frames();
      EXPECT_TRUE(basis.expired());
      recorder.expect_order();
      if (!frames.empty()) kept.push_back(frames.back());
      EXPECT_EQ(recorder.frames().size(), frames.size());
    }
    if (threads == 0) threads = thread_count();  // includes the workers of parallel loops, which stay
  }
  for (int look = 0; look < 1000 && thread_count() > threads; ++look)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  EXPECT_LE(thread_count(), threads);
  for (const LiveFrame& frame : kept) EXPECT_TRUE(frame.positions->allFinite());
}

/// Closes the object while other threads drag, query and wait.
TEST(LiveDeformer, CanBeClosedWhileOthersUseIt) {
  const Scene scene = make_scene(bumpy_sphere(3));
  for (int time = 0; time < 12; ++time) {
    Recorder recorder;
    LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::ft05));
    std::thread dragging([&] {
      while (live.drag(part_of_move(scene, 1)) > 0) std::this_thread::yield();
    });
    std::thread waiting([&] {
      for (;;) try {
          live.wait_until_exact();
        } catch (const Error& error) {
          EXPECT_EQ(error.code(), ErrorCode::cancelled);
          return;
        }
    });
    std::thread looking([&] {
      while (live.stage() != LiveStage::closed) live.basis();
    });
    std::this_thread::sleep_for(std::chrono::milliseconds(3 * time));
    live.close();
    dragging.join();
    waiting.join();
    looking.join();
    EXPECT_EQ(live.drag(part_of_move(scene, 1)), 0);
    recorder.expect_order();
  }
}

TEST(LiveDeformer, AStopOfTheContextClosesIt) {
  const Scene scene = make_scene(bumpy_sphere(3));
  std::stop_source stop;
  Context context;
  context.stop_token = stop.get_token();
  Recorder recorder;
  LiveDeformer live = make_live(scene, held_foot(scene), recorder, quick_options(DeformMethod::ft05), context);
  EXPECT_EQ(live.drag(part_of_move(scene, 1)), 1);
  stop.request_stop();
  EXPECT_EQ(live.stage(), LiveStage::closed);
  EXPECT_EQ(live.drag(part_of_move(scene, 1)), 0);
  EXPECT_EQ(error_of([&] { live.wait_until_exact(); }).first, "deform.live_deformer_closed");
}

/// A callback may drag, even during destruction, but must not wait for the next frame.
TEST(LiveDeformer, CallbacksMayDrag) {
  const Scene scene = make_scene(bumpy_sphere(3));
  Recorder recorder;
  LiveDeformer* object = nullptr;
  std::atomic<int> count = 0;
  LiveCallbacks callbacks;
  callbacks.frame = [&](const LiveFrame&) {
    EXPECT_EQ(error_of([&] { object->wait_until_exact(); }).first, "deform.wait_in_callback");
    object->drag(part_of_move(scene, 0.01 * (++count % 100)));
    count.notify_all();
  };
  {
    LiveDeformer live(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), callbacks,
                      quick_options(DeformMethod::ft05));
    object = &live;
    live.drag(part_of_move(scene, 1));
    for (int seen = 0; seen < 20; seen = count) count.wait(seen);
  }
  EXPECT_GE(count, 20);
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

TEST(LiveDeformer, TakesAMeshWithoutVertices) {
  Recorder recorder;
  LiveDeformer live(Points(0, 3), Triangles(0, 3), {.whole = true}, recorder.callbacks(),
                    quick_options(DeformMethod::corotational));
  live.drag({});
  live.wait_until_exact();
  EXPECT_EQ(recorder.frames().back().positions->rows(), 0);
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
    LiveDeformer live(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), recorder.callbacks(),
                      quick_options(DeformMethod::ft05),
                      {.threads = 0, .progress = progress, .stop_token = {}});
    live.drag(std::vector{HandlePose{}});
    return error_of([&] { live.wait_until_exact(); }).first;
  };
  static constexpr FactType by_callback{"test.cancelled", ErrorCode::cancelled, {}, "by the callback", ""};
  EXPECT_EQ(outcome([](std::string_view, double) { throw Error(Fact(by_callback, {})); }), by_callback.id);
  EXPECT_EQ(outcome([](std::string_view, double) { throw std::runtime_error("broken"); }), "core.defect");
}

TEST(LiveDeformer, TheProxyStaysWhereTheRestDoesNotFit) {
  const Scene scene = make_scene(bumpy_sphere(3));
  LiveOptions options = quick_options(DeformMethod::corotational);
  Context context;
  context.progress = [](std::string_view step, double) {  // simulates a set-up that runs out of memory
    if (step == "assemble") throw std::bad_alloc();
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
  for (const LiveFrame& frame : recorder.frames()) EXPECT_EQ(frame.quality, FrameQuality::proxy);
}

}  // namespace
}  // namespace meshgraft::test
