#include <meshgraft/linalg/linear_solver.h>

#include <cstddef>
#include <mutex>
#include <string_view>
#include <vector>

#include <meshgraft/core/error.h>

#include "blas_threads.h"
#include "core/parallel.h"
#include "core/platform/memory.h"
#include "core/platform/processor.h"
#include "linalg/facts.h"

#ifdef MESHGRAFT_HAS_OPENBLAS
extern "C" {
char* openblas_get_corename(void);
int openblas_get_num_threads(void);
void openblas_set_num_threads(int count);
#ifdef __ELF__  // These are undocumented and absent in some builds, hence weak symbols.
__attribute__((weak)) void* blas_memory_alloc(int unused);
__attribute__((weak)) void blas_memory_free(void* buffer);
#endif
}
#endif

namespace meshgraft {

std::string better_blas_kernels() {
#ifdef MESHGRAFT_HAS_OPENBLAS
  constexpr std::string_view fallback = "Prescott";
  if (openblas_get_corename() != fallback) return {};
  switch (platform::vector_instructions()) {
    case platform::VectorInstructions::avx512: return "SkylakeX";
    case platform::VectorInstructions::avx2: return "Haswell";
    case platform::VectorInstructions::baseline: break;
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
  int calling = 0;  ///< threads that may call BLAS at the same time
  int buffers = 0;  ///< buffers that OpenBLAS has mapped and keeps
};

Users& users() {
  static Users instance;
  return instance;
}

/// Makes OpenBLAS map buffers for this many threads. Throws Error(memory) if there is no room for them. Builds
/// that hide the functions for buffers map them later; for these this only checks the room.
void map_buffers([[maybe_unused]] int threads) {
#ifdef __ELF__
  const int missing = threads - users().buffers;
  if (missing <= 0) return;
  // Includes room for alignment. The buffers of scipy-openblas32, which hides the functions, have 32 MB.
  const std::size_t buffer_bytes = std::size_t{blas_memory_alloc != nullptr ? 129u : 33u} << 20;
  const std::size_t bytes = missing * buffer_bytes;
  if (!platform::can_reserve_address_space(bytes))
    throw Error(facts::linalg::NoRoomForBuffers{.megabytes = bytes >> 20});
  users().buffers = threads;
  if (blas_memory_alloc == nullptr) return;
  std::vector<void*> buffers;
  for (int thread = 0; thread < threads; ++thread) buffers.push_back(blas_memory_alloc(0));
  for (void* const buffer : buffers) blas_memory_free(buffer);
#endif
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
