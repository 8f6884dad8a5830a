#include "document.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

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

using Part = LocationPart;

bool is_document(const Location& location) {
  return !location.empty() && location.parts().front() == Part{Part::Kind::file, document_name};
}

// Returns whether the parts from `at` on begin with an element of this list.
bool is_element(const Location& location, std::size_t at, std::string_view list) {
  const std::vector<Part>& parts = location.parts();
  return at + 1 < parts.size() && parts[at].kind == Part::Kind::field && parts[at].name == list &&
         parts[at + 1].kind == Part::Kind::element;
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

ErrorLocation parts_of_location(const Location& location) {
  const std::vector<Part>& parts = location.parts();
  ErrorLocation told;
  std::size_t inner = is_document(location) ? 1 : 0;
  if (inner == 1 && is_element(location, 1, "steps")) {
    told.step = parts[2].index;
    inner = 3;
  }
  told.rest = location.from(inner).text();
  if (is_element(location, inner, "pairs")) told.pair = parts[inner + 1].index;
  for (std::size_t i = inner; i < parts.size(); ++i) {
    if (parts[i].kind == Part::Kind::handle) told.handle = parts[i].name;
    if (parts[i].kind == Part::Kind::file && !told.file) told.file = location.from(i).text();
  }
  return told;
}

Error with_handle_name(const Error& error, const Json& document) {
  const Location& location = error.location();
  if (!is_document(location) || !is_element(location, 1, "steps") || !is_element(location, 3, "handles"))
    return error;
  const std::size_t step = location.parts()[2].index, handle = location.parts()[4].index;
  const Json::json_pointer name(fmt::format("/steps/{}/handles/{}/name", step, handle));
  if (!document.contains(name) || !document[name].is_string()) return error;
  return error.at((Location::file(document_name) / "steps")[step] /
                  Location::handle(document[name].get<std::string>()) / location.from(5));
}

Error in_file(const Error& error, const fs::path& file) {
  return is_document(error.location()) ? error.at(Location(file) / error.location().from(1)) : error;
}

Json new_edit(const std::string& name, const Json& input) {
  return {{"format", "meshgraft-edit"},
          {"version", 2},
          {"inputs", {{name, input}}},
          {"steps", {{{"kind", "deform"}, {"mesh", name}, {"region", {{"indices", Json::array()}}}}}}};
}

std::optional<std::size_t> step_in_work(const EditFile& edit) {
  if (deform_in_work(edit) == nullptr && merge_in_work(edit) == nullptr) return std::nullopt;
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
