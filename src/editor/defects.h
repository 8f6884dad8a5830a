#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/error.h>

#include "objects.h"
#include "protocol.h"

#include "script/run_steps.h"

namespace meshgraft::editor {

/// A note on a file, with the notes that give its details.
struct FileNote {
  Note note;
  std::vector<Note> details;
};

/// Returns whether a finding matters for editing. Boundary loops, open seams and polygons are no defects: edits
/// work across them.
bool matters(const Finding& finding);

/// Returns the findings on an object that matter, worst first, as the protocol has them.
Json findings_json(const MeshState& state);

/// Returns the finding by its kind's name, e.g. "zero-area-face". Throws Error(input) where the object has
/// none.
const Finding& finding_named(const Object& object, const std::string& name);

/// Returns notes on a file, by the name `file`: io.other_format, and on the defects of its mesh that matter for
/// editing. These are editor.defects with the findings as its details, or editor.size_not_shown, or
/// editor.no_surface.
std::vector<FileNote> notes_on_file(const MeshState& state, const std::filesystem::path& file);

/// Returns the notes as the protocol has them.
Json file_notes_json(std::span<const FileNote> notes);

}  // namespace meshgraft::editor
