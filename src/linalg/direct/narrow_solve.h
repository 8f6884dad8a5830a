#pragma once

#include "core/platform/processor.h"

namespace meshgraft {

// Substitution for few right-hand sides. Reading the panel takes the time then, and up to six right-hand sides
// share it. BLAS would pack the panel first. The last bits of a result depend on the vector instructions, which
// are by default the widest that the processor has.

/// Computes x₁ ← L₁₁⁻¹ x₁, then x₂ ← x₂ − L₂₁ x₁. `panel` is rows×columns and x rows×width, both column-major.
void solve_narrow_panel(const double* panel, int rows, int columns, double* x, int width,
                        platform::VectorInstructions instructions = platform::vector_instructions());

/// Computes x₁ ← L₁₁⁻ᵀ (x₁ − L₂₁ᵀ x₂).
void solve_narrow_panel_transposed(const double* panel, int rows, int columns, double* x, int width,
                                   platform::VectorInstructions instructions = platform::vector_instructions());

// The same with a panel in single precision.
void solve_narrow_panel(const float* panel, int rows, int columns, double* x, int width,
                        platform::VectorInstructions instructions = platform::vector_instructions());
void solve_narrow_panel_transposed(const float* panel, int rows, int columns, double* x, int width,
                                   platform::VectorInstructions instructions = platform::vector_instructions());

}  // namespace meshgraft
