#pragma once

#include "io/format.h"

namespace meshgraft::io {

/// 3MF, the 3D Manufacturing Format: a ZIP archive of XML. lib3mf reads the objects and their placements.
/// Coordinates are read and rewritten in the XML itself, so that unchanged coordinates keep their digits and
/// all other content its bytes.
Format threemf_format();

Mesh read_threemf(std::string content, const std::string& name, MemoryBudget& budget, const Context& context);
Written write_threemf(const Mesh& mesh, const std::filesystem::path& path, const WriteOptions& options,
                      const Context& context);

}  // namespace meshgraft::io
