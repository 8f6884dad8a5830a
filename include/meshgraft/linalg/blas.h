#pragma once

#include <string>

namespace meshgraft {

/// An OpenBLAS that is older than the processor runs kernels for one of the year 2004, and factorisation takes
/// twice as long. Where that has happened, this is what the environment variable OPENBLAS_CORETYPE should say
/// instead; it is read when OpenBLAS is loaded, so a program has to be started with it. Empty where there is
/// nothing to gain, or no OpenBLAS.
std::string better_blas_kernels();

}  // namespace meshgraft
