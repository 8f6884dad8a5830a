#pragma once

#include "io/format.h"

namespace meshgraft::io {

/// OFF, the text format of Geomview, with any of the prefixes ST, C and N.
Format off_format();

bool has_off_signature(std::string_view content);
Mesh read_off(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);
Written write_off(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                  const Context& context);

}  // namespace meshgraft::io
