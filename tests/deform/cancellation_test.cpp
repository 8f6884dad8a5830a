#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <random>
#include <stop_token>
#include <thread>

#include <gtest/gtest.h>
#if defined(MESHGRAFT_SANITIZES_ADDRESSES) || defined(MESHGRAFT_SANITIZES_THREADS)
#define MESHGRAFT_SANITIZED 1
extern "C" std::size_t __sanitizer_get_current_allocated_bytes();  // GCC installs no header that declares it
#else
#define MESHGRAFT_SANITIZED 0
#include <malloc.h>
#endif

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>

#include "support/scene_edits.h"

namespace meshgraft::test {
namespace {

std::int64_t allocated_bytes() {
#if MESHGRAFT_SANITIZED
  return static_cast<std::int64_t>(__sanitizer_get_current_allocated_bytes());
#else
  const struct mallinfo2 info = mallinfo2();
  return static_cast<std::int64_t>(info.uordblks + info.hblkhd);
#endif
}

int thread_count() {
  namespace fs = std::filesystem;
  return static_cast<int>(std::distance(fs::directory_iterator("/proc/self/task"), fs::directory_iterator()));
}

/// Waits until no more than `count` threads run, so that calls left behind have freed their memory.
void wait_for_threads(int count) {
  while (thread_count() > count) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// Runs `work` with a stop at its step number `last`; returns whether it was cancelled.
bool cancelled_at(int last, const std::function<void(const Context&)>& work) {
  std::stop_source stop;
  int step = 0;
  Context context{.threads = 2, .progress = {}, .stop_token = stop.get_token()};
  context.progress = [&](const Progress&) {
    if (++step == last) stop.request_stop();
  };
  try {
    work(context);
    return false;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
    return true;
  }
}

constexpr int moments = MESHGRAFT_SANITIZED ? 4 : 12;
constexpr std::int64_t slack = 1 << 20;  // bytes that libraries keep for each thread that once ran

TEST(Cancellation, ACancelledSetUpLeavesNothingBehind) {
  const Scene scene = make_scene(bumpy_sphere(4));
  const std::vector poses{pose_of(head_move(scene))};
  const auto set_up = [&](const Context& context) {
    return Deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), {}, context);
  };
  int steps = 0;
  const Context counting{.threads = 2, .progress = [&](const Progress&) { ++steps; }, .stop_token = {}};
  const Points expected = set_up(counting).evaluate(poses);
  ASSERT_GT(steps, 3);
  cancelled_at(steps / 2, set_up);
  const int threads = thread_count();
  const std::int64_t before = allocated_bytes();
  int cancelled = 0;
  for (int last = 1; last <= steps; last += 1 + steps / moments) {
    cancelled += cancelled_at(last, set_up);
    wait_for_threads(threads);
    EXPECT_LT(allocated_bytes(), before + slack) << "step " << last << " of " << steps;
  }
  EXPECT_GE(cancelled, 3);
  EXPECT_EQ(set_up({.threads = 2, .progress = {}, .stop_token = {}}).evaluate(poses), expected);
}

TEST(Cancellation, ACancelledEvaluationLeavesTheDeformerAsItWas) {
  const Scene scene = make_scene(bumpy_sphere(4));
  const std::vector poses{pose_of(head_move(scene))};
  for (const DeformMethod method : {DeformMethod::ft05, DeformMethod::rotation_aware,
                                    DeformMethod::corotational, DeformMethod::shell}) {
    DeformerOptions options;
    options.method = method;
    const Deformer deformer(scene.mesh.positions, scene.mesh.triangles, held_foot(scene), options);
    const Points expected = deformer.evaluate(poses);
    const std::int64_t before = allocated_bytes();
    std::minstd_rand generator(11);
    for (int run = 0; run < 10; ++run) {
      std::stop_source stop;
      const std::jthread other([&] {
        std::this_thread::sleep_for(std::chrono::microseconds(generator() % 20'000));
        stop.request_stop();
      });
      try {
        EXPECT_EQ(deformer.evaluate(poses, {.threads = 2, .progress = {}, .stop_token = stop.get_token()}),
                  expected);
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled);
      }
    }
    EXPECT_LT(allocated_bytes(), before + slack) << to_string(method);
    EXPECT_EQ(deformer.evaluate(poses), expected) << to_string(method);
  }
}

}  // namespace
}  // namespace meshgraft::test
