#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <meshgraft/edit/edit_file.h>

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

/// The deform step that is worked on: the last one; absent where that is a cut or a merge.
std::optional<std::size_t> step_in_work(const EditFile& edit);
const DeformStep* deform_in_work(const EditFile& edit);

/// Whether a step has something to move and something to move it by.
bool is_ready(const DeformStep& step);

/// The document as it is saved: last steps without handles are left out, and relative paths start from
/// `folder`.
EditFile saved_form(const Document& document, const std::filesystem::path& folder);

}  // namespace meshgraft::editor
