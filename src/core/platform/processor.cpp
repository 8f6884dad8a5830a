#include "processor.h"

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

}  // namespace meshgraft::platform
