#pragma once

#include <string>

namespace meshgraft {

/// Returns the better value of the environment variable OPENBLAS_CORETYPE, or an empty string if there is
/// nothing to gain or no OpenBLAS. An OpenBLAS older than the processor runs kernels for a processor of 2004,
/// and factorisation takes twice as long. OpenBLAS reads the variable when it is loaded, so the program has
/// to be started with it.
std::string better_blas_kernels();

}  // namespace meshgraft
