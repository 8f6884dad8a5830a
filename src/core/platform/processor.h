#pragma once

namespace meshgraft::platform {

enum class VectorInstructions {
  baseline,  ///< those that every processor of its architecture has, or unknown
  avx2,      ///< AVX2 and FMA
  avx512,    ///< AVX-512 F, DQ, BW and VL, too
};

/// The widest vector instructions that the processor and the system offer.
VectorInstructions vector_instructions();

}  // namespace meshgraft::platform
