#pragma once

#include <cstdint>

namespace meshgraft::render {

/// Scatters the bits of a number (the finaliser of splitmix64).
inline std::uint64_t scattered(std::uint64_t bits) {
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  return bits ^ (bits >> 31);
}

/// Random numbers from 0 to 1 that depend on two numbers alone: a hash of them and of a counter (splitmix64).
class Random {
 public:
  Random(std::uint32_t pixel, std::uint32_t sample) : state_((std::uint64_t{pixel} << 20) ^ sample) {}

  float next() {
    state_ += 0x9E3779B97F4A7C15ull;
    return static_cast<float>(scattered(state_) >> 40) * 0x1.0p-24f;
  }

 private:
  std::uint64_t state_;
};

}  // namespace meshgraft::render
