#pragma once

#include "core/platform/processor.h"

namespace meshgraft {

// Substitution for many right-hand sides. A row of x stays in registers while a few columns of the panel are
// read, so that the panel need not be packed as BLAS does. The last bits of a result depend on the vector
// instructions, which are by default the widest that the processor has.

constexpr int wide_columns = 32;  ///< number of right-hand sides

/// Computes x₁ ← L₁₁⁻¹ x₁, then x₂ ← x₂ − L₂₁ x₁. `panel` is rows×columns, column-major; x is
/// rows×wide_columns, stored row by row.
void solve_wide_panel(const double* panel, int rows, int columns, double* x,
                      platform::VectorInstructions instructions = platform::vector_instructions());

/// Computes x₁ ← L₁₁⁻ᵀ (x₁ − L₂₁ᵀ x₂).
void solve_wide_panel_transposed(const double* panel, int rows, int columns, double* x,
                                 platform::VectorInstructions instructions = platform::vector_instructions());

}  // namespace meshgraft
