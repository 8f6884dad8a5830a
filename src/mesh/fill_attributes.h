#pragma once

#include <span>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Interpolates linear attributes and directions at the vertices inside filled holes, where all faces are
/// flagged `is_new`. The interpolation is harmonic (cotangent weights), from the values around the holes. It
/// reproduces linear functions of position on a flat patch. Vertex attributes take the values at the vertices
/// around a hole. Corner attributes take the values at the corners of the new faces there. Other attributes
/// stay unchanged.
void interpolate_in_fills(Mesh& mesh, std::span<const std::uint8_t> is_new, const Context& context);

}  // namespace meshgraft
