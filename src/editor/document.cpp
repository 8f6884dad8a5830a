#include "document.h"

#include <algorithm>
#include <charconv>
#include <utility>

#include "script/json_value.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

constexpr const char* document_name = "edit";

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

bool is_empty(const SelectionSpec& selection) {
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

DocumentPlace place_in_document(std::string_view location) {
  const auto drop = [&](std::string_view beginning) {
    const bool begins = location.starts_with(beginning);
    if (begins) location.remove_prefix(beginning.size());
    return begins;
  };
  if (location == document_name) return {};
  DocumentPlace place;
  if (drop(std::string(document_name) + ": ") && drop("steps[")) {
    std::size_t step = 0;
    const auto [end, failed] = std::from_chars(location.data(), location.data() + location.size(), step);
    location.remove_prefix(static_cast<std::size_t>(end - location.data()));
    place.step = step;
    drop("]");
    drop(".") || drop(": ");
  }
  place.rest = location;
  return place;
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
