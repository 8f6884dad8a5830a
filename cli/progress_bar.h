#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace meshgraft::cli {

/// Shows on the terminal what a long command is doing, from one second after its start on. Shows nothing where
/// standard error is not a terminal.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// `fraction` of the stage that is done; negative where it cannot be told.
  void update(std::string_view stage, double fraction);

 private:
  void run();
  void draw();

  using Clock = std::chrono::steady_clock;
  const Clock::time_point start_ = Clock::now();
  std::mutex mutex_;
  std::condition_variable end_;
  std::string stage_;
  double fraction_ = -1;
  bool finished_ = false;
  bool drawn_ = false;
  std::thread drawer_;
};

}  // namespace meshgraft::cli
