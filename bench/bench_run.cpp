#include "bench_run.h"

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <fstream>
#include <sstream>

namespace meshgraft::bench {

void report(benchmark::State& state, const Stages& stages) {
  double total = 0;
  for (const auto& [name, seconds] : stages) {
    state.counters[name] += seconds;
    total += seconds;
  }
  state.SetIterationTime(total);
}

void average(benchmark::State& state) {
  for (auto& [name, counter] : state.counters) counter.value /= static_cast<double>(state.iterations());
}

void add(const std::string& name, const std::function<void(benchmark::State&)>& body) {
  benchmark::RegisterBenchmark(name.c_str(), body)
      ->UseManualTime()
      ->Iterations(1)
      ->Unit(benchmark::kMillisecond);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double seconds(const std::function<void()>& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

double median_seconds(int calls, const std::function<void()>& work) {
  std::vector<double> times;
  for (int call = 0; call < calls; ++call) times.push_back(seconds(work));
  return median(std::move(times));
}

namespace {

/// Returns the value of a line "name: … kB" of /proc/self/status, in bytes.
std::int64_t status_bytes(const std::string& name) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    std::istringstream words(line);
    std::string key;
    std::int64_t kilobytes = 0;
    if (words >> key >> kilobytes && key == name + ":") return 1024 * kilobytes;
  }
  return 0;
}

}  // namespace

PeakMemory::PeakMemory() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << "5";  // resets the high-water mark VmHWM
  before_ = status_bytes("VmRSS");
}

std::int64_t PeakMemory::bytes() const { return status_bytes("VmHWM") - before_; }

bool is_available(SolverBackend backend) {
  const auto backends = available_backends();
  return std::find(backends.begin(), backends.end(), backend) != backends.end();
}

}  // namespace meshgraft::bench
