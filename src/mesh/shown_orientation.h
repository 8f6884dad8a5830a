#pragma once

#include <meshgraft/mesh/orientation.h>

namespace meshgraft {

/// Returns how a model is shown. Its upper side is what its source states; else it is the usual one, unless
/// another one, y or z, is very likely by the shape (`guess_orientations`). Its front is the likeliest one for
/// this upper side. About 0.1 s for a million triangles.
Orientation shown_orientation(const Mesh& mesh);

}  // namespace meshgraft
