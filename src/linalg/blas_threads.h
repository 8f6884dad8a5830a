#pragma once

#include <meshgraft/core/context.h>

namespace meshgraft {

/// Keeps OpenBLAS on one thread for as long as one of these lives: on several it sums in another order, and
/// the same edit would give other bytes with another number of threads. OpenBLAS knows this setting for the
/// whole process only, so the last one out puts it back.
class SingleThreadedBlas {
 public:
  /// Of a caller that calls BLAS on as many threads as the context has. OpenBLAS maps a buffer of 128 MB for
  /// each, and where it cannot, tries for ever: throws Error(memory) instead.
  explicit SingleThreadedBlas(const Context& context);
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;
  ~SingleThreadedBlas();

 private:
  int threads_ = 0;
};

}  // namespace meshgraft
