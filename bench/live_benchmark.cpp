// Measures how soon a large region can be dragged, how long frames take while the set-up goes on, and when
// they are exact. Prints the tables of docs/performance.md as Markdown.
//
//   meshgraft_live [--vertices N,N,…] [--method NAME] [--proxy-from N] [--drag | --close]

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <map>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/deform/live_deformer.h>

#include "../cli/blas_kernels.h"
#include "bench_edit.h"
#include "number_list.h"

namespace meshgraft::bench {
namespace {

struct Settings {
  std::vector<Index> vertices{250'000};
  LiveOptions live{};
  enum class Scenario { still, drag, close } scenario = Scenario::still;
};

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

/// Interpolates the pose's matrix: `part` 0 is rest, 1 is the edit's pose.
std::vector<HandlePose> pose_of(const BenchEdit& edit, double part) {
  HandlePose pose;
  pose.transform.matrix() = (1 - part) * Eigen::Matrix4d::Identity() + part * edit.pose.matrix();
  return {pose};
}

/// Records frames as they arrive.
class Recorder {
 public:
  struct Entry {
    double at;
    std::int64_t pose;
    FrameAccuracy accuracy;
    double seconds;
    std::optional<double> error;
  };
  LiveCallbacks callbacks() {
    return {[this](const LiveFrame& frame) {
              const std::lock_guard lock(mutex_);
              entries_.push_back({now(), frame.pose, frame.accuracy, frame.seconds, frame.error_rel});
            },
            [](std::int64_t pose, const Error& error) { fmt::print("pose {}: {}\n", pose, error.what()); }};
  }
  std::vector<Entry> entries() const {
    const std::lock_guard lock(mutex_);
    return entries_;
  }

 private:
  mutable std::mutex mutex_;
  std::vector<Entry> entries_;
};

/// Returns the seconds until everything is made, if no handle is dragged meanwhile.
double seconds_untouched(const BenchEdit& edit, const LiveOptions& options) {
  Recorder recorder;
  const double start = now();
  const LiveDeformer live({edit.positions, edit.triangles, region_of(edit)}, recorder.callbacks(), options);
  while (live.stage() != LiveStage::ready) sleep(0.01);
  return now() - start;
}

/// Drags one pose right after construction, and two more when everything is made.
void run_still(const BenchEdit& edit, const LiveOptions& options) {
  const double untouched = seconds_untouched(edit, options);
  sleep(8);  // a virtual machine may give free memory back to its host meanwhile
  Recorder recorder;
  const double start = now();
  LiveDeformer live({edit.positions, edit.triangles, region_of(edit)}, recorder.callbacks(), options);
  const double constructed = now();
  live.drag(pose_of(edit, 1));
  live.wait_until_exact();
  const double exact = now();
  while (live.stage() != LiveStage::ready) sleep(0.01);
  const double ready = now();
  for (const double part : {0.9, 0.95}) {
    live.drag(pose_of(edit, part));
    live.wait_until_exact();
  }
  const auto entries = recorder.entries();
  const Recorder::Entry quick = entries[entries.size() - 2], last = entries.back();
  fmt::print("| {} | {} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} | {:.2f} | {:.2g} |\n",
             edit.positions.rows(), to_string(options.deformer.method), 1e3 * (constructed - start),
             entries.front().at - start, exact - start, ready - start, untouched, 1e3 * quick.seconds,
             last.seconds, 100 * quick.error.value_or(0));
  std::fflush(stdout);
}

/// Drags sixty poses a second until two seconds after everything is made, then stops. Prints by stage how
/// long frames took, and how old the poses were when their frames arrived.
void run_drag(const BenchEdit& edit, const LiveOptions& options) {
  struct Frames {
    std::vector<double> seconds, lags;
  };
  Recorder recorder;
  std::vector<double> asked{0};
  std::vector<std::pair<double, LiveStage>> stages;
  const double start = now();
  LiveDeformer live({edit.positions, edit.triangles, region_of(edit)}, recorder.callbacks(), options);
  double ready = 0;
  for (int step = 0; ready == 0 || now() < ready + 2; ++step) {
    stages.emplace_back(now(), live.stage());
    if (ready == 0 && stages.back().second == LiveStage::ready) ready = now();
    asked.push_back(now());
    live.drag(pose_of(edit, 0.5 + 0.4 * std::sin(0.05 * step)));
    sleep(1.0 / 60);
  }
  const double rested = now();
  live.wait_until_exact();
  const double exact = now();
  std::map<std::pair<LiveStage, FrameAccuracy>, Frames> by_stage;
  for (const Recorder::Entry& entry : recorder.entries()) {
    if (entry.at > rested) continue;
    const auto after = std::upper_bound(stages.begin(), stages.end(), entry.at,
                                        [](double at, const auto& stage) { return at < stage.first; });
    Frames& frames = by_stage[{(after - 1)->second, entry.accuracy}];
    frames.seconds.push_back(entry.seconds);
    frames.lags.push_back(entry.at - asked[static_cast<std::size_t>(entry.pose)]);
  }
  const auto rank = [](std::vector<double> values, double part) {
    std::sort(values.begin(), values.end());
    return 1e3 * values[static_cast<std::size_t>(part * static_cast<double>(values.size() - 1))];
  };
  for (const auto& [key, frames] : by_stage)
    fmt::print("| {} | {} | {} | {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} |\n",
               edit.positions.rows(), to_string(options.deformer.method), to_string(key.first),
               to_string(key.second), frames.seconds.size(), rank(frames.seconds, 0.5),
               rank(frames.seconds, 0.95), rank(frames.seconds, 1), rank(frames.lags, 0.5),
               rank(frames.lags, 0.95));
  for (std::size_t i = 1; i < stages.size(); ++i)
    if (stages[i].second != stages[i - 1].second)
      fmt::print("{} after {:.2f} s; ", to_string(stages[i].second), stages[i].first - start);
  fmt::print("exact {:.2f} s after the drag\n", exact - rested);
  std::fflush(stdout);
}

/// Measures the age of a pose at its first frame, where it interrupts the exact evaluation of the one before.
void run_interrupt(const BenchEdit& edit, const LiveOptions& options) {
  Recorder recorder;
  LiveDeformer live({edit.positions, edit.triangles, region_of(edit)}, recorder.callbacks(), options);
  while (live.stage() < LiveStage::exact) sleep(0.01);
  std::vector<double> asked{0}, lags;
  for (int step = 0; step < 12; ++step) {
    asked.push_back(now());
    live.drag(pose_of(edit, 0.5 + 0.04 * step));
    sleep(0.7);
  }
  std::int64_t last = 0;
  for (const Recorder::Entry& entry : recorder.entries()) {
    if (entry.pose == last) continue;
    last = entry.pose;
    lags.push_back(entry.at - asked[static_cast<std::size_t>(entry.pose)]);
  }
  std::sort(lags.begin(), lags.end());
  fmt::print("first frame after an interruption: {:.0f} ms median, {:.0f} ms at most\n",
             1e3 * lags[lags.size() / 2], 1e3 * lags.back());
}

/// Measures how long destruction takes at different moments of the set-up.
void run_close(const BenchEdit& edit, const LiveOptions& options) {
  double longest = 0, longest_after = 0, sum = 0;
  constexpr int times = 20;
  for (int i = 0; i < times; ++i) {
    Recorder recorder;
    double before = 0;
    const double wait = 0.02 + 0.35 * i;
    {
      LiveDeformer live({edit.positions, edit.triangles, region_of(edit)}, recorder.callbacks(), options);
      live.drag(pose_of(edit, 1));
      sleep(wait);
      before = now();
    }
    const double took = now() - before;
    sum += took;
    if (took > longest) longest = took, longest_after = wait;
  }
  fmt::print("destruction: {:.0f} ms in the mean, {:.0f} ms at most (after {:.2f} s)\n", 1e3 * sum / times,
             1e3 * longest, longest_after);
}

Settings parse(int count, char** arguments) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string_view name = arguments[i];
    const std::string value = i + 1 < count ? arguments[i + 1] : "";
    if (name == "--drag" || name == "--close") {
      settings.scenario = name == "--drag" ? Settings::Scenario::drag : Settings::Scenario::close;
      continue;
    }
    ++i;
    if (name == "--vertices") settings.vertices = numbers(value);
    if (name == "--proxy-from") settings.live.proxy_from = static_cast<Index>(std::stol(value));
    if (name == "--method")
      for (const DeformMethod method :
           {DeformMethod::ft05, DeformMethod::rotation_aware, DeformMethod::corotational})
        if (to_string(method) == value) settings.live.deformer.method = method;
  }
  return settings;
}

void run(const Settings& settings) {
  using enum Settings::Scenario;
  if (settings.scenario == still)
    fmt::print(
        "| vertices | method | constructor, ms | first frame, s | exact, s | all made, s | untouched, s | "
        "quick frame, ms | exact alone, s | error, % |\n");
  if (settings.scenario == drag)
    fmt::print("| vertices | method | stage | frames | number | median | p95 | max | lag | lag p95 |\n");
  for (const Index vertices : settings.vertices) {
    const BenchEdit edit = make_bump_edit(vertices);
    if (settings.scenario == still) run_still(edit, settings.live);
    if (settings.scenario == drag) run_drag(edit, settings.live);
    if (settings.scenario != close) continue;
    run_interrupt(edit, settings.live);
    run_close(edit, settings.live);
  }
}

}  // namespace
}  // namespace meshgraft::bench

int main(int count, char** arguments) {
  meshgraft::cli::restart_with_better_blas_kernels(arguments);
  meshgraft::bench::run(meshgraft::bench::parse(count, arguments));
  return EXIT_SUCCESS;
}
