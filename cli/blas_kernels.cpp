#include "blas_kernels.h"

#include <cstdlib>
#include <string>

#include <unistd.h>

#include <meshgraft/linalg/blas.h>

namespace meshgraft::cli {

void restart_with_better_blas_kernels(char** argv) {
  constexpr const char *kernels_variable = "OPENBLAS_CORETYPE", *threads_variable = "OPENBLAS_NUM_THREADS";
  const std::string kernels = std::getenv(kernels_variable) == nullptr ? better_blas_kernels() : std::string();
  if (kernels.empty() && std::getenv(threads_variable) != nullptr) return;
  if (!kernels.empty() && setenv(kernels_variable, kernels.c_str(), 0) != 0) return;
  // Threads of its own are never used, and where memory is short the program would wait for them when it ends.
  if (setenv(threads_variable, "1", 1) != 0) return;
  execv("/proc/self/exe", argv);
}

}  // namespace meshgraft::cli
