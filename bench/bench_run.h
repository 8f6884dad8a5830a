#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include <benchmark/benchmark.h>

#include <meshgraft/deform/deformer.h>
#include <meshgraft/mesh/mesh.h>

#include "bench_edit.h"

namespace meshgraft::bench {

/// Makes a task once per size; all benchmarks of that size share it.
template <class Task, Task (*make)(Index)>
class BySize {
 public:
  const Task& operator[](Index size) {
    const auto [entry, is_new] = made_.try_emplace(size);
    if (is_new) entry->second = make(size);
    return entry->second;
  }

 private:
  std::map<Index, Task> made_;
};
using Edits = BySize<BenchEdit, make_bump_edit>;

using Stages = std::vector<std::pair<std::string, double>>;  ///< name, seconds

/// Adds the stages to the counters, and sets the iteration's time to their sum.
void report(benchmark::State& state, const Stages& stages);
/// Divides the counters by the number of iterations, over which they were summed.
void average(benchmark::State& state);
/// Registers a benchmark of one iteration, which is timed by its stages.
void add(const std::string& name, const std::function<void(benchmark::State&)>& body);

double median(std::vector<double> values);
double seconds(const std::function<void()>& work);
/// Returns the median time of some calls.
double median_seconds(int calls, const std::function<void()>& work);

/// Measures the process's peak of resident memory since construction, less the memory that it had then.
class PeakMemory {
 public:
  PeakMemory();
  std::int64_t bytes() const;

 private:
  std::int64_t before_ = 0;
};

bool is_available(SolverBackend backend);

}  // namespace meshgraft::bench
