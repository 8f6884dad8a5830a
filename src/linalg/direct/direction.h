#pragma once

namespace meshgraft {

/// The halves of a substitution: forward is x ← L⁻¹ x, backward x ← L⁻ᵀ x.
enum class Direction { forward, backward };

}  // namespace meshgraft
