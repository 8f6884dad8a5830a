// Measures how soon operations end that are cancelled. Prints the tables of docs/performance.md as Markdown.
//
//   meshgraft_cancel [--vertices N,N,…] [--only TEXT] [--moments N] [--repeats N] [--gaps]
//
// By the clock: each operation is cancelled at moments spread over its duration. With `--gaps` each runs once,
// to the end, and the longest processor time between two checks for cancellation is measured. That time does
// not depend on other work of the machine.

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "../cli/blas_kernels.h"
#include "number_list.h"
#include "support/cancel_cases.h"
#include "support/check_gaps.h"

namespace meshgraft::bench {
namespace {

struct Settings {
  std::vector<Index> vertices{100'000};
  std::string only;
  int moments = 10, repeats = 1;
  bool gaps = false;
};

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

double process_seconds() {
  timespec time{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void sleep(double seconds) { std::this_thread::sleep_for(std::chrono::duration<double>(seconds)); }

double resident_mib() {
  std::ifstream file("/proc/self/statm");
  double total = 0, resident = 0;
  file >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE)) / 1048576;
}

/// Returns the processor time that the process takes from now until it rests.
double leftover_seconds() {
  const double start = process_seconds();
  constexpr double look = 0.05;
  for (double before = start;;) {
    sleep(look);
    const double after = process_seconds();
    if (after - before < 0.1 * look) return before - start;
    before = after;
  }
}

struct Cancelled {
  bool in_time = false;  ///< whether the stop came before the end
  double latency = 0, leftover = 0;
};

Cancelled cancel_after(const test::CancellableCall& call, double seconds) {
  std::stop_source stop;
  const Context context{.threads = 0, .progress = {}, .stop_token = stop.get_token()};
  Cancelled result;
  double returned = 0;
  std::thread caller([&] {
    try {
      const auto kept = call(context);
      returned = now();
    } catch (const Error& error) {
      returned = now();
      result.in_time = error.code() == ErrorCode::cancelled;
    }
  });
  sleep(seconds);
  const double asked = now();
  stop.request_stop();
  caller.join();
  result.latency = std::max(0.0, returned - asked);
  result.leftover = leftover_seconds();
  return result;
}

void cancel_at_moments(const std::string& name, Index vertices, const test::CancellableCall& call,
                       const Settings& settings) {
  double start = now();
  std::stop_source never;
  call({.threads = 0, .progress = {}, .stop_token = never.get_token()}).reset();
  const double duration = now() - start;
  leftover_seconds();
  const double memory = resident_mib();
  std::vector<double> latencies;
  double leftover = 0;
  for (int moment = 0; moment < settings.moments; ++moment) {
    double least = -1;
    for (int repeat = 0; repeat < settings.repeats; ++repeat) {
      const Cancelled result = cancel_after(call, duration * (moment + 0.5) / settings.moments);
      if (!result.in_time) continue;
      if (least < 0 || result.latency < least) least = result.latency;
      leftover = std::max(leftover, result.leftover);
    }
    if (least >= 0) latencies.push_back(least);
  }
  std::sort(latencies.begin(), latencies.end());
  if (latencies.empty()) latencies.push_back(0);
  fmt::print("| {} | {} | {:.2f} | {:.0f} | {:.0f} | {:.2f} | {:.0f} |\n", name, vertices, duration,
             1e3 * latencies[latencies.size() / 2], 1e3 * latencies.back(), leftover,
             std::max(0.0, resident_mib() - memory));
}

void find_gaps(const std::string& name, Index vertices, const test::CancellableCall& call) {
  std::stop_source never;
  const double start = now(), processor = process_seconds();
  test::CheckGaps gaps;
  const auto kept = call({.threads = 0, .progress = {}, .stop_token = never.get_token()});
  gaps.end();
  const double duration = now() - start, worked = process_seconds() - processor;
  fmt::print("| {} | {} | {:.2f} | {:.2f} | {:.0f} | {} | {} |\n", name, vertices, duration, worked,
             1e3 * gaps.longest_seconds(), gaps.stage(), gaps.checks());
}

Settings parse(int count, char** arguments) {
  Settings settings;
  for (int i = 1; i < count; ++i) {
    const std::string_view name = arguments[i];
    if (name == "--gaps") {
      settings.gaps = true;
      continue;
    }
    const std::string value = ++i < count ? arguments[i] : "";
    if (name == "--vertices") settings.vertices = numbers(value);
    if (name == "--only") settings.only = value;
    if (name == "--moments") settings.moments = std::atoi(value.c_str());
    if (name == "--repeats") settings.repeats = std::atoi(value.c_str());
  }
  return settings;
}

void run(const Settings& settings) {
  if (settings.gaps)
    fmt::print("| operation | vertices | seconds | processor, s | longest gap, ms | stage | checks |\n");
  else
    fmt::print("| operation | vertices | seconds | median, ms | worst, ms | leftover, s | memory, MiB |\n");
  fmt::print("|---|---|---|---|---|---|---|\n");
  for (const test::CancelCase& each : test::cancel_cases())
    for (const Index vertices : settings.vertices) {
      if (each.name.find(settings.only) == std::string::npos || vertices > each.most_vertices) continue;
      try {
        const test::CancellableCall call = each.prepare(vertices);
        if (settings.gaps)
          find_gaps(each.name, vertices, call);
        else
          cancel_at_moments(each.name, vertices, call, settings);
      } catch (const std::exception& error) {
        fmt::print("| {} | {} | {} |\n", each.name, vertices, error.what());
      }
      std::fflush(stdout);
    }
}

}  // namespace
}  // namespace meshgraft::bench

int main(int count, char** arguments) {
  meshgraft::cli::restart_with_better_blas_kernels(arguments);
  meshgraft::bench::run(meshgraft::bench::parse(count, arguments));
  return EXIT_SUCCESS;
}
