#pragma once

#include <vector>

#include <meshgraft/io/textures.h>

#include "document.h"

namespace meshgraft::io {

/// The pictures of all materials' base colours, by the labels that a mesh of the file has. What is missing or
/// malformed is left out.
std::vector<MaterialTexture> textures_of(const GltfDocument& document);

}  // namespace meshgraft::io
