#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>

namespace meshgraft::editor {

using Json = nlohmann::json;

/// The document that is edited. It is kept as a parsed edit file, as JSON for changes, and as the bytes that
/// saving writes.
struct Document {
  EditFile edit;
  Json json;
  std::string text;
};

/// Makes a document from JSON in its one canonical form. Throws what `parse_edit` throws.
Document make_document(const Json& json, const std::filesystem::path& base_folder);

/// Makes a document from its bytes, or from those of an edit file.
Document parse_document(std::string_view text, const std::filesystem::path& base_folder);

/// The location of an error in the parts that the page names.
struct ErrorLocation {
  std::optional<std::size_t> step;    ///< index from 0; none: outside the steps
  std::optional<std::string> handle;  ///< its name
  std::optional<std::size_t> pair;    ///< index from 0 of a pair of a graft
  std::optional<std::string> file;    ///< a path, with the line or the field in it
  std::string rest;                   ///< in the step, or in the document: "settings.stiffness"
};
ErrorLocation parts_of_location(const Location& location);

/// Returns the error with a location that has the name of a handle in place of its number in the document.
Error with_handle_name(const Error& error, const Json& document);

/// Returns an error about a document that was read from `file` with the file in its location.
Error in_file(const Error& error, const std::filesystem::path& file);

/// Returns an edit with one input (as in `inputs` of an edit file) and one step that does nothing yet.
Json new_edit(const std::string& name, const Json& input);

/// Returns the index of the current step: the last step, if it is a deformation or a graft. Returns nothing
/// for a last step of another kind.
std::optional<std::size_t> step_in_work(const EditFile& edit);
const DeformStep* deform_in_work(const EditFile& edit);
const MergeStep* merge_in_work(const EditFile& edit);

/// Returns the name of the mesh that the current step deforms or grafts onto; without such a step, the name
/// of the edit's outcome.
const std::string& model_of(const EditFile& edit);

/// Returns whether a step has a region that is not empty and a handle or constraint that can move it.
bool is_ready(const DeformStep& step);

/// Returns the document as it is saved. Last steps without handles are left out and relative paths start from
/// `folder`. The output is the model, whichever mesh the last step works on.
EditFile saved_form(const Document& document, const std::filesystem::path& folder);

}  // namespace meshgraft::editor
