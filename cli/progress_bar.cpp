#include "progress_bar.h"

#include <algorithm>
#include <cstdio>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "core/platform/terminal.h"
#include "progress_text.h"

namespace meshgraft::cli {

namespace {

constexpr std::chrono::milliseconds delay{1000}, frame{100};
constexpr int bar_width = 28;
constexpr std::string_view erase_line = "\r\x1b[K";

}  // namespace

ProgressBar::ProgressBar() {
  if (platform::stderr_is_terminal()) drawer_ = std::thread([this] { run(); });
}

ProgressBar::~ProgressBar() {
  {
    const std::lock_guard lock(mutex_);
    finished_ = true;
  }
  end_.notify_all();
  if (drawer_.joinable()) drawer_.join();
  if (drawn_) fmt::print(stderr, "{}", erase_line);
}

void ProgressBar::update(const Progress& progress) {
  std::string text = progress_text(progress);
  const std::lock_guard lock(mutex_);
  text_ = std::move(text);
  fraction_ = progress.fraction;
}

void ProgressBar::run() {
  std::unique_lock lock(mutex_);
  if (end_.wait_for(lock, delay, [this] { return finished_; })) return;
  while (!finished_) {
    draw();
    end_.wait_for(lock, frame, [this] { return finished_; });
  }
}

void ProgressBar::draw() {
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  if (fraction_ < 0) {
    fmt::print(stderr, "{}{}  {:.1f} s", erase_line, text_, seconds);
  } else {
    const double done = std::clamp(fraction_, 0.0, 1.0);
    const int filled = static_cast<int>(done * bar_width);
    fmt::print(stderr, "{}{:<10} [{:#<{}}{:.<{}}] {:3.0f} %  {:.1f} s", erase_line, text_, "", filled, "",
               bar_width - filled, 100 * done, seconds);
  }
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace meshgraft::cli
