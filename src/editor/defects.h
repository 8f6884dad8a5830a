#pragma once

#include <optional>
#include <string>

#include "script/run_steps.h"

namespace meshgraft::editor {

/// What of a file's mesh stands in the way of editing it, in a sentence with the command that mends it, or that
/// its size cannot be shown; absent where nothing does. Boundary loops, open seams and polygons are nothing of
/// the kind: edits go on across them.
std::optional<std::string> defect_note(const Scene& scene, const std::string& file);

}  // namespace meshgraft::editor
