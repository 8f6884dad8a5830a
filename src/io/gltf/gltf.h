#pragma once

#include "io/format.h"

namespace meshgraft::io {

/// glTF 2.0: .glb, and .gltf with its buffers beside it or inside it.
Format gltf_format();

Mesh read_gltf(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);
Written write_gltf(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                   const Context& context);

}  // namespace meshgraft::io
