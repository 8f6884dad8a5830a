#include "one_thread.h"

#ifdef _OPENMP
#include <omp.h>
#endif

namespace meshgraft {

// The one file that is compiled with OpenMP.
void with_one_openmp_thread(const std::function<void()>& work) {
#ifdef _OPENMP
  if (omp_in_parallel() == 0) {
#pragma omp teams num_teams(1) thread_limit(1)
    work();
    return;
  }
#endif
  work();  // regions within a caller's own have one thread anyway
}

}  // namespace meshgraft
