#pragma once

#include <filesystem>
#include <string>

#include "document.h"

namespace meshgraft::editor {

// Changes of a document as JSON that concern parts, cuts and grafts; `edit` is the document before. A step in
// work that does nothing yet gives way to them; one that does something is done then.

/// Throws Error(usage), telling to end it first, where a graft is in work.
void require_no_graft(const EditFile& edit, const std::string& what);

/// A file as an input of an edit in `folder`: its path from there on where it lies below, and its hash. Throws
/// Error(io).
Json file_input(const std::filesystem::path& folder, const std::filesystem::path& file);

/// An input beside the others, as an edit file has it. Returns its name: `name`, or, where that is taken and
/// `may_number`, that with a number. Throws Error(input) for a name that is taken.
std::string add_part(Json& document, const EditFile& edit, const Json& input, const std::string& name,
                     bool may_number);

/// With the steps that are about it alone. Throws Error(input) for the model, and for what is no input or is
/// part of a graft.
void remove_part(Json& document, const EditFile& edit, const std::string& name);

/// Makes it what is worked on.
void edit_part(Json& document, const EditFile& edit, const std::string& name);

/// A cut step, whose `mesh` is the model or a part.
void add_cut(Json& document, const EditFile& edit, Json step);

/// Starts a graft, or changes the one in work: the fields of a merge step, null to take one away; of
/// `settings` those that are named. Throws
/// Error(input) where it is not clear which part is meant, or it is the model itself.
void set_graft(Json& document, const EditFile& edit, const Json& fields);
void cancel_graft(Json& document, const EditFile& edit);
/// Exchanges target and source, with the pairs; what is said of one of them alone goes.
void swap_graft(Json& document, const EditFile& edit);

/// Whether a mesh went into a graft before the step in work.
bool is_grafted(const EditFile& edit, const std::string& name);

}  // namespace meshgraft::editor
