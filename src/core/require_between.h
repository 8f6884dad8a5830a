#pragma once

#include <meshgraft/core/error.h>

#include "core/facts.h"

namespace meshgraft {

/// The largest angle that is accepted, either way. A double keeps a larger one to no more than 1e-10 degrees.
inline constexpr double largest_accepted_angle_deg = 1e6;

/// Throws Error(input) with the id core.out_of_range at `location` unless low ≤ value ≤ high.
inline void require_between(double value, double low, double high, const char* location) {
  if (!(value >= low && value <= high))
    throw Error(facts::core::OutOfRange{.value = value, .low = low, .high = high}, location);
}

}  // namespace meshgraft
