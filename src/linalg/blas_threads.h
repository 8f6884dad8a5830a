#pragma once

namespace meshgraft {

/// Keeps OpenBLAS on one thread for as long as one of these lives: on several it sums in another order, and
/// the same edit would give other bytes with another number of threads. OpenBLAS knows this setting for the
/// whole process only, so the last one out puts it back.
class SingleThreadedBlas {
 public:
  SingleThreadedBlas();
  SingleThreadedBlas(const SingleThreadedBlas&) = delete;
  SingleThreadedBlas& operator=(const SingleThreadedBlas&) = delete;
  ~SingleThreadedBlas();
};

}  // namespace meshgraft
