#pragma once

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

namespace meshgraft::bench {

/// Prints the runs, and at the end how many times as long as meshgraft's the others of each group took, by
/// medians. A run is named "GROUP / WHO"; WHO is "meshgraft" for the one to compare with.
class RatioReporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    ConsoleReporter::ReportRuns(runs);
    for (const Run& run : runs)
      if (run.run_type == Run::RT_Iteration)
        times_[run.run_name.function_name].push_back(run.GetAdjustedRealTime());
  }
  void Finalize() override {
    for (auto& [name, times] : times_) {
      const std::string group = name.substr(0, name.find(" / "));
      const double ours = median(times_[group + " / meshgraft"]);
      if (ours > 0)
        std::printf("%-50s %8.3g ms, %.2f × meshgraft\n", name.c_str(), median(times), median(times) / ours);
    }
  }

 private:
  static double median(std::vector<double>& values) {
    if (values.empty()) return 0;
    const auto middle = values.begin() + std::ssize(values) / 2;
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }
  std::map<std::string, std::vector<double>> times_;
};

}  // namespace meshgraft::bench
