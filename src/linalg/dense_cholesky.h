#pragma once

#include <meshgraft/core/context.h>

namespace meshgraft {

// Dense kernels on column-major matrices: BLAS on one thread, large ones cut into tiles that run side by side.
// How a matrix is cut depends on its size alone, so the result does not depend on the number of threads.

/// Cholesky factor of the first `columns` columns of a lower triangle, in place: A₁₁ = L₁₁ L₁₁ᵀ and
/// L₂₁ = A₂₁ L₁₁⁻ᵀ. `panel` is rows×columns. Returns the first column whose pivot is not positive, or
/// `columns`.
int factorise_panel(double* panel, int rows, int columns, const Context& context);

/// update = −L₂₁ L₂₁ᵀ (lower triangle), of the rows below the first `columns` of a factorised panel.
void form_update(const double* panel, int rows, int columns, double* update, const Context& context);

/// x₁ ← L₁₁⁻¹ x₁, then x₂ ← x₂ − L₂₁ x₁; x is rows×width, column by column.
void solve_panel(const double* panel, int rows, int columns, double* x, int width);

/// x₁ ← L₁₁⁻ᵀ (x₁ − L₂₁ᵀ x₂).
void solve_panel_transposed(const double* panel, int rows, int columns, double* x, int width);

}  // namespace meshgraft
