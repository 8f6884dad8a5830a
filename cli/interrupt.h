#pragma once

#include <stop_token>
#include <thread>

namespace meshgraft::cli {

/// Turns Ctrl-C (and SIGTERM) into a stop request. A second one ends the program at once.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  std::stop_token token() const { return source_.get_token(); }

 private:
  std::stop_source source_;
  std::thread watcher_;
};

}  // namespace meshgraft::cli
