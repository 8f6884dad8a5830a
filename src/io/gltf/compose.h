#pragma once

#include <optional>

#include "io/format.h"

namespace meshgraft::io {

/// A glTF file for a mesh that has none with its faces: a node per object, a primitive per material, vertices
/// split where the values of their corners differ. Throws Error(input) for coordinates that are not finite or
/// too large for floats.
Written compose_gltf(const Mesh& mesh, const std::filesystem::path& path,
                     const std::optional<MorphTarget>& morph_target, const Context& context);

}  // namespace meshgraft::io
