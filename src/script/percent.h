#pragma once

#include <cmath>
#include <string>

#include <fmt/format.h>

namespace meshgraft {

/// Returns a share in per cent, as a power of ten if it is a million per cent or more.
inline std::string percent(double share) {
  return std::abs(share) < 1e4 ? fmt::format("{:.1f} %", 100 * share) : fmt::format("{:.2e} %", 100 * share);
}

/// Returns how much more or less than 1 a ratio is, in per cent with its sign.
inline std::string percent_change(double ratio) { return (ratio < 1 ? "" : "+") + percent(ratio - 1); }

}  // namespace meshgraft
