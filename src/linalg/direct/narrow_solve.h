#pragma once

#include "core/platform/processor.h"

namespace meshgraft {

// Substitution for few right-hand sides or a small panel. Reading the panel takes the time then, and up to six
// right-hand sides share it. BLAS would pack the panel first. The last bits of a result depend on the vector
// instructions, which are by default the widest that the processor has.

/// Does what `solve_panel` does.
void solve_narrow_panel(const double* panel, int rows, int columns, double* x, int width,
                        platform::VectorInstructions instructions = platform::vector_instructions());

/// Does what `solve_panel_transposed` does.
void solve_narrow_panel_transposed(const double* panel, int rows, int columns, double* x, int width,
                                   platform::VectorInstructions instructions = platform::vector_instructions());

}  // namespace meshgraft
