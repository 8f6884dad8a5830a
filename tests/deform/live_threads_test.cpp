// A live deformation may be destroyed, closed and used by several threads at any moment.
#include <atomic>
#include <chrono>
#include <filesystem>
#include <memory>
#include <random>
#include <stop_token>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/live_deformer.h>

#include "live_recorder.h"
#include "support/mesh_families.h"
#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

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
    LiveDeformer live({scene.mesh.positions, scene.mesh.triangles, held_foot(scene)}, callbacks,
                      quick_options(DeformMethod::ft05));
    object = &live;
    live.drag(part_of_move(scene, 1));
    for (int seen = 0; seen < 20; seen = count) count.wait(seen);
  }
  EXPECT_GE(count, 20);
}

}  // namespace
}  // namespace meshgraft::test
