#pragma once

namespace meshgraft::cli {

/// Starts the program anew with OPENBLAS_CORETYPE set where OpenBLAS did not recognise the processor
/// (linalg/blas.h): the variable is read before main. Returns where there is nothing to gain, where the user
/// has set the variable, and where the program cannot be started again.
void restart_with_better_blas_kernels(char** argv);

}  // namespace meshgraft::cli
