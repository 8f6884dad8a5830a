#include "document.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include <fmt/format.h>

#include "script/json_value.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

constexpr const char* document_name = "edit";
constexpr const char* in_document = "edit: ";

fs::path rebased(const std::string& file, const fs::path& from, const fs::path& to) {
  const fs::path path(file);
  return path.is_absolute() ? path : fs::relative(from / path, to);
}

// Rewrites the paths of the files that a selection or a pose names.
void rebase_files(Json& json, const fs::path& from, const fs::path& to) {
  if (!json.is_structured()) return;
  for (const char* key : {"file", "sel", "def"})
    if (json.is_object() && json.contains(key) && json[key].is_string())
      json[key] = rebased(json[key].get<std::string>(), from, to).string();
  for (Json& part : json) rebase_files(part, from, to);
}

// Takes a beginning off a text, if it begins so.
bool drop(std::string_view& text, std::string_view beginning) {
  if (!text.starts_with(beginning)) return false;
  text.remove_prefix(beginning.size());
  return true;
}

// Takes "5]" off a text.
std::size_t take_index(std::string_view& text) {
  std::size_t index = 0;
  const auto [end, failed] = std::from_chars(text.data(), text.data() + text.size(), index);
  text.remove_prefix(end - text.data());
  drop(text, "]");
  return index;
}

bool is_empty(const EditSelection& selection) {
  const auto* indices = std::get_if<Selection::Indices>(&selection.kind);
  return indices != nullptr && indices->vertices.empty();
}

}  // namespace

Document parse_document(std::string_view text, const fs::path& base_folder) {
  Document document;
  document.edit = parse_edit(text, document_name, base_folder);
  document.text = write_edit(document.edit);
  document.json = Json::parse(document.text);
  return document;
}

Document make_document(const Json& json, const fs::path& base_folder) {
  return parse_document(json.dump(-1, ' ', false, Json::error_handler_t::replace), base_folder);
}

ErrorLocation parts_of_location(std::string_view location) {
  ErrorLocation parts;
  if (location == document_name) return parts;
  if (fs::path(location).is_absolute()) parts.file = location;
  if (drop(location, in_document) && drop(location, "steps[")) {
    parts.step = take_index(location);
    drop(location, ".") || drop(location, ": ");
  }
  parts.rest = location;
  if (drop(location, "handle '")) parts.handle = location.substr(0, location.rfind('\''));
  if (drop(location, "pairs[")) parts.pair = take_index(location);
  return parts;
}

Error with_handle_name(const Error& error, const Json& document) {
  std::string_view rest = error.location();
  if (!drop(rest, in_document) || !drop(rest, "steps[")) return error;
  const std::size_t step = take_index(rest);
  if (!drop(rest, ".handles[")) return error;
  const std::size_t handle = take_index(rest);
  const Json::json_pointer name(fmt::format("/steps/{}/handles/{}/name", step, handle));
  if (!document.contains(name) || !document[name].is_string()) return error;
  return error.at(
      fmt::format("{}steps[{}]: handle '{}'{}", in_document, step, document[name].get<std::string>(), rest));
}

Error in_file(const Error& error, const fs::path& file) {
  std::string_view inner = error.location();
  return drop(inner, document_name) ? error.at(file.string() + std::string(inner)) : error;
}

Json new_edit(const std::string& name, const Json& input) {
  return {{"format", "meshgraft-edit"},
          {"version", 2},
          {"inputs", {{name, input}}},
          {"steps", {{{"kind", "deform"}, {"mesh", name}, {"region", {{"indices", Json::array()}}}}}}};
}

std::optional<std::size_t> step_in_work(const EditFile& edit) {
  if (edit.steps.empty() || std::holds_alternative<CutStep>(edit.steps.back().action)) return std::nullopt;
  return edit.steps.size() - 1;
}

const DeformStep* deform_in_work(const EditFile& edit) {
  return edit.steps.empty() ? nullptr : std::get_if<DeformStep>(&edit.steps.back().action);
}

const MergeStep* merge_in_work(const EditFile& edit) {
  return edit.steps.empty() ? nullptr : std::get_if<MergeStep>(&edit.steps.back().action);
}

const std::string& model_of(const EditFile& edit) {
  if (const auto step = step_in_work(edit)) return mesh_of(edit.steps[*step]);
  return edit.output.empty() ? outcome_of(edit.steps.back()) : edit.output;
}

bool is_ready(const DeformStep& step) {
  return !is_empty(step.region) && (!step.handles.empty() || !step.targets.empty() || !step.transforms.empty());
}

EditFile saved_form(const Document& document, const fs::path& folder) {
  Json json = document.json;
  Json& steps = json["steps"];
  for (std::size_t left = document.edit.steps.size(); left > 1; --left) {
    const auto* step = std::get_if<DeformStep>(&document.edit.steps[left - 1].action);
    if (step == nullptr || is_ready(*step)) break;
    steps.erase(left - 1);
  }
  if (document.edit.output.empty()) {
    const EditStep& last = document.edit.steps[steps.size() - 1];
    const std::string& outcome =
        step_in_work(document.edit) ? outcome_of(document.edit.steps.back()) : model_of(document.edit);
    if (outcome_of(last) != outcome) json["output"] = outcome;
  }
  const fs::path& from = document.edit.base_folder;
  if (from != folder)
    for (const char* part : {"inputs", "selections", "steps"})
      if (json.contains(part))
        for (Json& element : json[part]) rebase_files(element, from, folder);
  return make_document(json, folder).edit;
}

}  // namespace meshgraft::editor
