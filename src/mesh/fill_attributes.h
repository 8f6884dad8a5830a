#pragma once

#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Interpolates linear attributes and directions at the vertices inside filled holes, those of which all faces
/// are flagged `is_new`: harmonically (cotangent weights) from the values around the holes. On a flat patch a
/// linear function of position comes out as itself. Vertex attributes have values at the vertices around a
/// hole; corner attributes have them at the corners of the new faces there. Leaves other attributes as they
/// are.
void interpolate_in_fills(Mesh& mesh, std::span<const std::uint8_t> is_new, const Context& context);

}  // namespace meshgraft
