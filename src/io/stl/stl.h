#pragma once

#include "io/format.h"

namespace meshgraft::io {

/// STL, binary and ascii.
Format stl_format();

bool has_stl_signature(std::string_view content);
Mesh read_stl(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);
Written write_stl(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                  const Context& context);

}  // namespace meshgraft::io
