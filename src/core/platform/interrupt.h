#pragma once

#include <functional>
#include <thread>

namespace meshgraft::platform {

/// Calls a function, on a thread of its own, each time the program is asked to end: by Ctrl-C or, where there
/// is such a thing, SIGTERM. At most one exists at a time; without it such a request ends the program.
class InterruptWatch {
 public:
  /// Throws std::system_error where the system has no room for it.
  explicit InterruptWatch(std::function<void()> on_interrupt);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

 private:
  std::function<void()> on_interrupt_;
  std::thread watcher_;
};

}  // namespace meshgraft::platform
