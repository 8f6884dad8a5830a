#pragma once

#include <Eigen/Core>

// Loops over four columns gain from the processor's widest registers, but the library is built for any
// processor.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__) && \
    !defined(MESHGRAFT_SANITIZES_ADDRESSES) && !defined(MESHGRAFT_SANITIZES_THREADS)
#define MESHGRAFT_WIDEST_REGISTERS [[gnu::target_clones("arch=x86-64-v4", "arch=x86-64-v3", "default")]]
#else
#define MESHGRAFT_WIDEST_REGISTERS
#endif

namespace meshgraft {

/// Four right-hand sides or solutions: one row per row of the nodes, zero in padding rows.
using FourColumns = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

/// The four columns of a row, in one register or two (GCC and Clang choose). The address needs no alignment
/// beyond that of a double.
using Four [[gnu::vector_size(32), gnu::aligned(8), gnu::may_alias]] = double;

inline const Four* rows_of(const FourColumns& x) { return reinterpret_cast<const Four*>(x.data()); }
inline Four* rows_of(FourColumns& x) { return reinterpret_cast<Four*>(x.data()); }

}  // namespace meshgraft
