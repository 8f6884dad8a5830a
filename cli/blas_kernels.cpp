#include "blas_kernels.h"

#include <cstdlib>
#include <string>

#include <unistd.h>

#include <meshgraft/linalg/blas.h>

namespace meshgraft::cli {

void restart_with_better_blas_kernels(char** argv) {
  constexpr const char* variable = "OPENBLAS_CORETYPE";
  if (std::getenv(variable) != nullptr) return;
  const std::string kernels = better_blas_kernels();
  if (kernels.empty() || setenv(variable, kernels.c_str(), 0) != 0) return;
  execv("/proc/self/exe", argv);
}

}  // namespace meshgraft::cli
