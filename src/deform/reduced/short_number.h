#pragma once

#include <cmath>

namespace meshgraft {

/// Returns a number in single precision, or 0 below 1e-18. The products of two such numbers are never denormal.
/// Processors multiply those many times more slowly.
inline float short_number(double number) { return std::abs(number) < 1e-18 ? 0 : static_cast<float>(number); }

}  // namespace meshgraft
