#pragma once

#include <algorithm>

namespace meshgraft {

/// Returns ℓ̄/ℓ, bounded, because extreme ratios would drown all other rows in rounding errors.
inline double density_scale(double length_ratio) {
  constexpr double largest = 1e3;
  return std::clamp(length_ratio, 1 / largest, largest);
}

}  // namespace meshgraft
