#pragma once

#include <string>

#include <fmt/format.h>

namespace meshgraft {

/// Returns how much more or less than 1 a ratio is, in per cent with its sign.
inline std::string percent_change(double ratio) { return fmt::format("{:+.1f} %", 100 * (ratio - 1)); }

}  // namespace meshgraft
