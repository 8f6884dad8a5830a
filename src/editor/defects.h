#pragma once

#include <optional>
#include <string>

#include "script/run_steps.h"

namespace meshgraft::editor {

/// Returns a sentence about the defects of a file's mesh that prevent editing, with the command that repairs
/// them, or about a size that cannot be shown. Returns nothing for a mesh without such defects. Boundary
/// loops, open seams and polygons are no defects: edits work across them.
std::optional<std::string> defect_note(const Scene& scene, const std::string& file);

}  // namespace meshgraft::editor
