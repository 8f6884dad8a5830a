#pragma once

namespace meshgraft::platform {

enum class VectorInstructions {
  baseline,  ///< those that every processor of the architecture has, or unknown
  avx2,      ///< AVX2 and FMA
  avx512,    ///< also AVX-512 F, DQ, BW and VL
};

/// Returns the widest vector instructions that the processor and the system support.
VectorInstructions vector_instructions();

/// Returns whether the processor tells that it is a virtual machine's.
bool is_virtual_machine();

}  // namespace meshgraft::platform
