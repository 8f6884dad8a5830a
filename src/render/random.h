#pragma once

#include <cstdint>

#include "core/scattered_bits.h"

namespace meshgraft::render {

/// Random numbers from 0 to 1 that depend on two numbers alone: a hash of them and of a counter (splitmix64).
class Random {
 public:
  Random(std::uint32_t pixel, std::uint32_t sample) : state_((std::uint64_t{pixel} << 20) ^ sample) {}

  float next() {
    state_ += splitmix_step;
    return static_cast<float>(scattered_bits(state_) >> 40) * 0x1.0p-24f;
  }

 private:
  std::uint64_t state_;
};

}  // namespace meshgraft::render
