#pragma once

#include <cstdint>
#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/quality.h>

namespace meshgraft {

/// The place where a surface is narrowest for its width at rest.
struct Narrowest {
  double width = 1;   ///< edited / rest
  Index vertex = -1;  ///< -1: nothing has a width
};

/// Finds where the width of the body that a surface encloses shrinks most. The width at a vertex is the
/// distance to the opposite point, where a ray from the vertex at rest against its normal leaves the body.
/// The opposite point moves with its triangle. Only widths of at least an edge's length count, and up to the
/// size of the free part. The width is 0 where the body is turned through itself. Of more than 20,000 free
/// vertices, that many are measured, evenly spread over their numbers.
Narrowest find_narrowest(const EditedMesh& mesh, std::span<const std::uint8_t> is_free, const Context& context);

}  // namespace meshgraft
