#pragma once

namespace meshgraft::cli {

/// Restarts the program with OPENBLAS_CORETYPE set if OpenBLAS did not recognise the processor
/// (`better_blas_kernels`), and with OPENBLAS_NUM_THREADS set to 1. A restart is needed because OpenBLAS reads
/// these variables before main. So does glibc, which a restarted program asks for large pages by GLIBC_TUNABLES,
/// except on a virtual machine. Returns if there is nothing to gain, if the user has set the variables, or if
/// the program cannot be restarted.
void restart_with_better_blas_kernels(char** argv);

}  // namespace meshgraft::cli
