#pragma once

#include <filesystem>
#include <vector>

#include <meshgraft/core/error.h>

#include "script/run_steps.h"

namespace meshgraft::editor {

/// Returns notes on the defects of a file's mesh that matter for editing: editor.defects, with the file and the
/// name of a repaired copy, and the findings; or editor.size_not_shown, or editor.no_surface. Returns nothing
/// for a mesh without such defects. Boundary loops, open seams and polygons are no defects: edits work across
/// them.
std::vector<Note> defect_notes(const MeshState& state, const std::filesystem::path& file);

}  // namespace meshgraft::editor
