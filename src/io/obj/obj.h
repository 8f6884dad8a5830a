#pragma once

#include "io/format.h"

namespace meshgraft::io {

/// Wavefront OBJ, polygonal part. All other content of a file is kept as text.
Format obj_format();

Mesh read_obj(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);
Written write_obj(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                  const Context& context);

}  // namespace meshgraft::io
