#include "processor.h"

#if defined(__x86_64__) && defined(__GNUC__)
#include <cpuid.h>
#endif

namespace meshgraft::platform {

VectorInstructions vector_instructions() {
#if defined(__x86_64__) && defined(__GNUC__)
  if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
      __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
    return VectorInstructions::avx512;
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return VectorInstructions::avx2;
#endif
  return VectorInstructions::baseline;
}

bool is_virtual_machine() {
#if defined(__x86_64__) && defined(__GNUC__)
  constexpr unsigned features_leaf = 1, hypervisor_bit = 1U << 31;
  unsigned a = 0, b = 0, c = 0, d = 0;
  return __get_cpuid(features_leaf, &a, &b, &c, &d) != 0 && (c & hypervisor_bit) != 0;
#else
  return false;
#endif
}

}  // namespace meshgraft::platform
