#pragma once

#include <chrono>
#include <condition_variable>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace meshgraft::cli {

/// Shows the progress of a command on the terminal, from one second after its start. Shows nothing if
/// standard error is not a terminal.
class ProgressBar {
 public:
  ProgressBar();
  ~ProgressBar();
  ProgressBar(const ProgressBar&) = delete;
  ProgressBar& operator=(const ProgressBar&) = delete;

  /// Sets the stage and the fraction of it that is done. A negative fraction means that it is unknown.
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
