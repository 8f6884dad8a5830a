#pragma once

#include <meshgraft/core/context.h>

namespace meshgraft {

// Dense kernels on column-major matrices. BLAS runs on one thread, and large matrices are cut into tiles that
// run in parallel. The cut depends only on a matrix's size, so the result does not depend on the number of
// threads.

/// Computes the Cholesky factor of the first `columns` columns of a lower triangle in place: A₁₁ = L₁₁ L₁₁ᵀ
/// and L₂₁ = A₂₁ L₁₁⁻ᵀ. `panel` is rows×columns. Returns the first column with a pivot that is not positive,
/// or `columns`.
int factorise_panel(double* panel, int rows, int columns, const Context& context);

/// Computes update = −L₂₁ L₂₁ᵀ (lower triangle) for the rows below the first `columns` of a factorised panel.
void form_update(const double* panel, int rows, int columns, double* update, const Context& context);

/// Computes update ← update + L₂₁ L₂₁ᵀ (lower triangle).
void take_back_update(const double* panel, int rows, int columns, double* update, const Context& context);

/// Computes the panel that `factorise_panel` had: `restored` = (A₁₁ over A₂₁), with zeros above the diagonal.
void restore_panel(const double* panel, int rows, int columns, double* restored, const Context& context);

}  // namespace meshgraft
