#pragma once

#include <meshgraft/core/context.h>

namespace meshgraft {

/// Keeps OpenBLAS on one thread while an instance exists. With several threads OpenBLAS sums in another
/// order, so the number of threads would change the bytes of a result. The setting is global to the process,
/// so the last instance restores it.
class SingleThreadedBlas {
 public:
  /// For a caller that calls BLAS on as many threads as the context has. OpenBLAS maps a buffer of 128 MB for
  /// each thread and retries for ever if it cannot. So this throws Error(memory) first.
  explicit SingleThreadedBlas(const Context& context);
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;
  ~SingleThreadedBlas();

 private:
  int threads_ = 0;
};

}  // namespace meshgraft
