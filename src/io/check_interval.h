#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// The number of elements that readers and writers handle between two checks for cancellation.
inline constexpr Index elements_per_check = 1 << 16;

}  // namespace meshgraft::io
