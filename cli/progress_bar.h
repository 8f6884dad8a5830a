#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <thread>

#include <meshgraft/core/context.h>

namespace meshgraft::cli {

/// Shows the progress of a command on the terminal, from one second after its start. Shows nothing if
/// standard error is not a terminal.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Sets what is shown.
  void update(const Progress& progress);

 private:
  void run();
  void draw();

  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::condition_variable end_;
  std::string text_;
  double fraction_ = -1;
  bool finished_ = false;
  bool drawn_ = false;
  std::thread drawer_;
};

}  // namespace meshgraft::cli
