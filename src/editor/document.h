#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <meshgraft/script/edit_file.h>

namespace meshgraft::editor {

using Json = nlohmann::json;

/// What is edited: an edit file, as the library knows it, as JSON to change, and as the bytes that saving
/// writes.
struct Document {
  EditFile edit;
  Json json;
  std::string text;
};

/// The document that `json` is, in the one form that it is written in. Throws what `parse_edit` throws.
Document make_document(const Json& json, const std::filesystem::path& base_folder);

/// The same from its bytes, or from an edit file's.
Document parse_document(std::string_view text, const std::filesystem::path& base_folder);

/// An edit of one input (as `inputs` of an edit file has it), with a step that does nothing yet.
Json new_edit(const std::string& name, const Json& input);

/// The step that is worked on: the last one, a deformation or a graft; absent where that is a cut.
std::optional<std::size_t> step_in_work(const EditFile& edit);
const DeformStep* deform_in_work(const EditFile& edit);
const MergeStep* merge_in_work(const EditFile& edit);

/// The mesh that is deformed, or grafted onto: that of the step in work, else what comes out of the edit.
const std::string& model_of(const EditFile& edit);

/// Whether a step has something to move and something to move it by.
bool is_ready(const DeformStep& step);

/// The document as it is saved: last steps without handles are left out, relative paths start from `folder`,
/// and what comes out is the model, whichever mesh the last step is about.
EditFile saved_form(const Document& document, const std::filesystem::path& folder);

}  // namespace meshgraft::editor
