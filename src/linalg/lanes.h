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

template <int lanes>
MESHGRAFT_INLINE void store(const Lanes<lanes>& values, double* to) {
  std::memcpy(to, &values, sizeof(values));
}

}  // namespace meshgraft::simd
