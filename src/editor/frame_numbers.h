#pragma once

#include <cstdint>
#include <mutex>

namespace meshgraft::editor {

/// Numbers the frames of one set-up as the page counts them. A parked set-up sends none. May be called from any
/// thread.
class FrameNumbers {
 public:
  explicit FrameNumbers(std::int64_t first) : first_(first) {}

  /// Calls `send` with the number of the set-up's frame `pose`, unless the set-up is parked.
  template <class Send>
  void number(std::int64_t pose, Send&& send) {
    const std::lock_guard lock(mutex_);
    if (!parked_) send(first_ + pose);
  }

  /// Parks the set-up, and waits for a frame that is being sent: messages that the caller sends later come
  /// after it. Returns the offset of the numbers.
  std::int64_t park() {
    const std::lock_guard lock(mutex_);
    parked_ = true;
    return first_;
  }

  void resume(std::int64_t first) {
    const std::lock_guard lock(mutex_);
    parked_ = false;
    first_ = first;
  }

 private:
  std::mutex mutex_;
  std::int64_t first_;
  bool parked_ = false;
};

}  // namespace meshgraft::editor
