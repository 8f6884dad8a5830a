#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

namespace meshgraft {

/// Returns the percentile by the nearest rank: the value of rank ⌈percent/100 · n⌉, counted from 1. Returns 0
/// for an empty list. Reorders `values`.
inline double percentile(std::vector<double>& values, double percent) {
  if (values.empty()) return 0;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(percent / 100 * static_cast<double>(values.size())));
  const auto at = values.begin() + std::clamp<std::ptrdiff_t>(rank - 1, 0, std::ssize(values) - 1);
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

}  // namespace meshgraft
