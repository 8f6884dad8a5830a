#pragma once

#include <optional>

#include "io/format.h"

namespace meshgraft::io {

/// Composes a new glTF file for a mesh that does not come from a glTF file with the same faces. It has a node
/// per object and a primitive per material. Vertices are split where the values of their corners differ.
/// Throws Error(input) for coordinates that are not finite or too large for floats.
Written compose_gltf(const Mesh& mesh, const std::filesystem::path& path,
                     const std::optional<MorphTarget>& morph_target, const Context& context);

}  // namespace meshgraft::io
