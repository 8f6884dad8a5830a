#pragma once

#include <cstdint>

namespace meshgraft {

/// Scatters the bits of a number (the finaliser of SplitMix64, Steele et al. 2014).
constexpr std::uint64_t scattered_bits(std::uint64_t number) {
  number = (number ^ (number >> 30)) * 0xbf58476d1ce4e5b9;
  number = (number ^ (number >> 27)) * 0x94d049bb133111eb;
  return number ^ (number >> 31);
}

/// The odd number by which states of SplitMix64 grow.
constexpr std::uint64_t splitmix_step = 0x9e3779b97f4a7c15;

}  // namespace meshgraft
