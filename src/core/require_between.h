#pragma once

#include <meshgraft/core/error.h>

#include "core/facts.h"

namespace meshgraft {

/// Throws Error(input) with the id core.out_of_range at `location` unless low ≤ value ≤ high.
inline void require_between(double value, double low, double high, const char* location) {
  if (!(value >= low && value <= high))
    throw Error(facts::core::OutOfRange{.value = value, .low = low, .high = high}, location);
}

}  // namespace meshgraft
