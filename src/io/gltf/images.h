#pragma once

#include <vector>

#include "document.h"
#include "io/textures.h"

namespace meshgraft::io {

/// Returns the images of all materials' base colours, by the material labels of the mesh. Missing and
/// malformed images are left out.
std::vector<MaterialTexture> textures_of(const GltfDocument& document);

}  // namespace meshgraft::io
