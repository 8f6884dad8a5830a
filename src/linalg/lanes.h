#pragma once

#include <cstring>

#define MESHGRAFT_INLINE [[gnu::always_inline]] inline

/// Vectors of doubles for kernels that are compiled for several sets of instructions. The functions are inlined
/// into one entry point for each set, which compiles them for it.
namespace meshgraft::simd {

/// `lanes` values that are computed together.
template <int lanes>
struct Vector {
  using Type [[gnu::vector_size(lanes * sizeof(double))]] = double;
  using Singles [[gnu::vector_size(lanes * sizeof(float))]] = float;
};
template <>
struct Vector<1> {
  using Type = double;
};
template <int lanes>
using Lanes = typename Vector<lanes>::Type;

template <int lanes>
MESHGRAFT_INLINE void load(const double* from, Lanes<lanes>& values) {
  std::memcpy(&values, from, sizeof(values));
}

/// Loads numbers in single precision.
template <int lanes>
MESHGRAFT_INLINE void load(const float* from, Lanes<lanes>& values) {
  if constexpr (lanes == 1) {
    values = *from;
  } else {
    typename Vector<lanes>::Singles singles;
    std::memcpy(&singles, from, sizeof(singles));
    values = __builtin_convertvector(singles, Lanes<lanes>);
  }
}

template <int lanes>
MESHGRAFT_INLINE void store(const Lanes<lanes>& values, double* to) {
  std::memcpy(to, &values, sizeof(values));
}

}  // namespace meshgraft::simd
