#pragma once

#include "io/format.h"

namespace meshgraft::io {

/// PLY: ascii, binary little endian and binary big endian.
Format ply_format();

bool has_ply_signature(std::string_view content);
Mesh read_ply(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);
Written write_ply(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                  const Context& context);

}  // namespace meshgraft::io
