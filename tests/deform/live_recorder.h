#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deformer.h>
#include <meshgraft/deform/live_deformer.h>
#include <meshgraft/deform/quick_frames.h>

#include "support/mesh_families.h"
#include "support/scene_edits.h"

/// Helpers of tests of live deformation.
namespace meshgraft::test {

inline const std::vector<DeformMethod> methods{DeformMethod::ft05, DeformMethod::rotation_aware,
                                               DeformMethod::corotational};

/// Returns options for tests: small models, no pause before the exact evaluation, and a proxy at any size.
inline LiveOptions quick_options(DeformMethod method) {
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

  /// Checks that poses come in order, that each pose's accuracies rise, and that no frame changed later.
  void expect_order() const {
    const std::lock_guard lock(mutex_);
    EXPECT_FALSE(overlapped_);
    for (std::size_t i = 0; i < frames_.size(); ++i) {
      EXPECT_TRUE(same_bytes(*frames_[i].positions, copies_[i]));
      if (i == 0) continue;
      const LiveFrame &before = frames_[i - 1], &after = frames_[i];
      EXPECT_LE(before.pose, after.pose);
      EXPECT_TRUE(before.pose < after.pose || before.accuracy < after.accuracy);
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

inline LiveDeformer make_live(const Scene& scene, const Region& region, Recorder& recorder,
                              const LiveOptions& options, const Context& context = {}) {
  return {{scene.mesh.positions, scene.mesh.triangles, region}, recorder.callbacks(), options, context};
}

inline Deformer make_direct(const Scene& scene, const Region& region, DeformMethod method) {
  DeformerOptions options;
  options.method = method;
  return {scene.mesh.positions, scene.mesh.triangles, region, options};
}

/// Returns a pose between rest (`part` 0) and the head's move (`part` 1).
inline std::vector<HandlePose> part_of_move(const Scene& scene, double part) {
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

inline std::vector<TestMesh> some_families() {
#ifdef MESHGRAFT_SANITIZES_THREADS  // threads meet alike on every mesh
  return {irregular_grid(20, 20)};
#else
  return {bumpy_sphere(3), irregular_grid(20, 20), bar(3, 14), torus(20, 12)};
#endif
}

}  // namespace meshgraft::test
