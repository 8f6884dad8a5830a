#include <meshgraft/linalg/linear_solver.h>

#include "blas_kernels.h"

#include <cstdlib>
#include <string>

#include "core/platform/process.h"
#include "core/platform/processor.h"

namespace meshgraft::cli {

void restart_with_better_blas_kernels(char** argv) {
  constexpr const char *kernels_variable = "OPENBLAS_CORETYPE", *threads_variable = "OPENBLAS_NUM_THREADS";
  const std::string kernels = std::getenv(kernels_variable) == nullptr ? better_blas_kernels() : std::string();
  if (kernels.empty() && std::getenv(threads_variable) != nullptr) return;
  if (!kernels.empty() && !platform::set_environment_variable(kernels_variable, kernels)) return;
  // OpenBLAS's own threads are never used. Where memory is short, the program would wait for them at its end.
  if (!platform::set_environment_variable(threads_variable, "1")) return;
  // With large pages, a deformation spends a third less time in the system, and some less by itself. A virtual
  // machine may give them back to its host whenever they are free, and waits for them each time then.
  constexpr const char* allocator_variable = "GLIBC_TUNABLES";
  if (std::getenv(allocator_variable) == nullptr && !platform::is_virtual_machine())
    platform::set_environment_variable(allocator_variable, "glibc.malloc.hugetlb=1");
  platform::restart_program(argv);
}

}  // namespace meshgraft::cli
