#pragma once

#include <vector>

#include <meshgraft/io/textures.h>

#include "document.h"

namespace meshgraft::io {

/// Returns the images of all materials' base colours, by the material labels of the mesh. Missing and
/// malformed images are left out.
std::vector<MaterialTexture> textures_of(const GltfDocument& document);

}  // namespace meshgraft::io
