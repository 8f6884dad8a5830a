#include "one_thread.h"

namespace meshgraft {

// The one file that is compiled with OpenMP. Without it the pragma does nothing.
void with_one_openmp_thread(const std::function<void()>& work) {
#ifdef _OPENMP
#pragma omp teams num_teams(1) thread_limit(1)
#endif
  {
    work();
  }
}

}  // namespace meshgraft
