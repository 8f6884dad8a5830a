#include <meshgraft/linalg/blas.h>

#include <sys/mman.h>

#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/core/parallel.h>

#include "blas_threads.h"

#ifdef MESHGRAFT_HAS_OPENBLAS
extern "C" {
char* openblas_get_corename(void);
int openblas_get_num_threads(void);
void openblas_set_num_threads(int count);
// Not of its documented interface: absent in some builds.
__attribute__((weak)) void* blas_memory_alloc(int unused);
__attribute__((weak)) void blas_memory_free(void* buffer);
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
  int calling = 0;  ///< threads that may call at the same time
  int buffers = 0;  ///< mapped, and kept by OpenBLAS
};

Users& users() {
  static Users instance;
  return instance;
}

/// Has OpenBLAS map buffers for so many threads, if there is room for them.
void map_buffers(int threads) {
  const int missing = threads - users().buffers;
  if (missing <= 0 || blas_memory_alloc == nullptr) return;
  constexpr std::size_t buffer_bytes = std::size_t{129} << 20;  // and some room for aligning it
  const std::size_t bytes = static_cast<std::size_t>(missing) * buffer_bytes;
  void* const room =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (room == MAP_FAILED)
    throw Error(ErrorCode::memory,
                fmt::format("there is no room for {} MB of buffers of OpenBLAS", bytes >> 20), "",
                "Give the program more memory, or fewer threads");
  munmap(room, bytes);
  std::vector<void*> buffers;
  for (int thread = 0; thread < threads; ++thread) buffers.push_back(blas_memory_alloc(0));
  for (void* const buffer : buffers) blas_memory_free(buffer);
  users().buffers = threads;
}

}  // namespace

SingleThreadedBlas::SingleThreadedBlas(const Context& context) : threads_(worker_threads(context)) {
  const std::lock_guard lock(users().mutex);
  map_buffers(users().calling + threads_);
  users().calling += threads_;
  if (users().count++ > 0) return;
  users().threads_before = openblas_get_num_threads();
  openblas_set_num_threads(1);
}

SingleThreadedBlas::~SingleThreadedBlas() {
  const std::lock_guard lock(users().mutex);
  users().calling -= threads_;
  if (--users().count == 0) openblas_set_num_threads(users().threads_before);
}

#else

SingleThreadedBlas::SingleThreadedBlas(const Context&) {}
SingleThreadedBlas::~SingleThreadedBlas() = default;

#endif

}  // namespace meshgraft
