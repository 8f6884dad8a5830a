#include <meshgraft/linalg/blas.h>

#include <mutex>
#include <string_view>

#include "blas_threads.h"

#ifdef MESHGRAFT_HAS_OPENBLAS
extern "C" {
char* openblas_get_corename(void);
int openblas_get_num_threads(void);
void openblas_set_num_threads(int count);
}
#endif

namespace meshgraft {

std::string better_blas_kernels() {
#if defined(MESHGRAFT_HAS_OPENBLAS) && defined(__x86_64__)
  constexpr std::string_view fallback = "Prescott";
  if (openblas_get_corename() == fallback) {
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
      return "SkylakeX";
    if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return "Haswell";
  }
#endif
  return {};
}

#ifdef MESHGRAFT_HAS_OPENBLAS

namespace {

struct Users {
  std::mutex mutex;
  int count = 0;
  int threads_before = 1;
};

Users& users() {
  static Users instance;
  return instance;
}

}  // namespace

SingleThreadedBlas::SingleThreadedBlas() {
  const std::lock_guard lock(users().mutex);
  if (users().count++ > 0) return;
  users().threads_before = openblas_get_num_threads();
  openblas_set_num_threads(1);
}

SingleThreadedBlas::~SingleThreadedBlas() {
  const std::lock_guard lock(users().mutex);
  if (--users().count == 0) openblas_set_num_threads(users().threads_before);
}

#else

SingleThreadedBlas::SingleThreadedBlas() = default;
SingleThreadedBlas::~SingleThreadedBlas() = default;

#endif

}  // namespace meshgraft
