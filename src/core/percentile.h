#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace meshgraft {

/// Returns percentiles by the nearest rank, for `percents` in ascending order: the values of rank
/// ⌈percent/100 · n⌉, counted from 1. Returns zeros for an empty list. Reorders `values`.
inline std::vector<double> percentiles(std::vector<double>& values, std::span<const double> percents) {
  std::vector<double> found(percents.size(), 0);
  if (values.empty()) return found;
  const auto rank = [&](double percent) {
    const auto above =
        static_cast<std::ptrdiff_t>(std::ceil(percent / 100 * static_cast<double>(values.size())));
    return std::clamp<std::ptrdiff_t>(above - 1, 0, std::ssize(values) - 1);
  };
  // Each rank that is found divides the values for those below and above it.
  const auto find = [&](const auto& self, std::size_t first, std::size_t last, std::ptrdiff_t low,
                        std::ptrdiff_t high) -> void {
    if (first == last) return;
    const std::size_t middle = (first + last) / 2;
    const std::ptrdiff_t at = std::max(low, rank(percents[middle]));
    if (at < high) std::nth_element(values.begin() + low, values.begin() + at, values.begin() + high);
    found[middle] = values[at];
    self(self, first, middle, low, std::min(at + 1, high));
    self(self, middle + 1, last, at, high);
  };
  find(find, 0, percents.size(), 0, std::ssize(values));
  return found;
}

/// Returns one percentile.
inline double percentile(std::vector<double>& values, double percent) {
  return percentiles(values, {&percent, 1}).front();
}

}  // namespace meshgraft
