#pragma once

#include <functional>
#include <thread>

namespace meshgraft::platform {

/// Calls a function, on a thread of its own, each time the program is asked to end, by Ctrl-C or, where they
/// exist, SIGTERM and SIGHUP. At most one instance exists at a time. Without an instance such a request ends the
/// program.
class InterruptWatch {
 public:
  /// Throws std::system_error if the system cannot create the pipe or the thread.
  explicit InterruptWatch(std::function<void()> on_interrupt);
  ~InterruptWatch();
  InterruptWatch(const InterruptWatch&) = delete;
  InterruptWatch& operator=(const InterruptWatch&) = delete;

 private:
  std::function<void()> on_interrupt_;
  std::thread watcher_;
};

}  // namespace meshgraft::platform
