#include "graft_actions.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "document_actions.h"
#include "editor/facts.h"
#include "io/file.h"
#include "script/facts.h"
#include "script/sha256.h"
#include "step_actions.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

bool is_taken(const EditFile& edit, const std::string& name) {
  return std::any_of(edit.inputs.begin(), edit.inputs.end(),
                     [&](const EditInput& input) { return input.name == name; }) ||
         std::any_of(edit.steps.begin(), edit.steps.end(),
                     [&](const EditStep& step) { return outcome_of(step) == name; });
}

// Returns the name, with a number where it is taken.
std::string free_name(const EditFile& edit, const std::string& name) {
  std::string free = name;
  for (int number = 2; is_taken(edit, free); ++number) free = fmt::format("{} {}", name, number);
  return free;
}

bool uses(const Json& step, const std::string& name) {
  const auto is_named = [&](const char* field) { return step.contains(field) && step[field] == name; };
  return is_named("mesh") || is_named("target") || is_named("source") || is_named("result");
}

// Returns whether a step makes a mesh of that name, other than by a graft: it changes it, or divides another.
bool makes(const EditStep& step, const std::string& name) {
  return !std::holds_alternative<MergeStep>(step.action) && outcome_of(step) == name;
}

// Ends the current step and returns the name of the model from then on. Removes the step where it does
// nothing.
std::string end_step_in_work(Json& document, const EditFile& edit) {
  const DeformStep* step = deform_in_work(edit);
  std::string model = model_of(edit);
  if (step == nullptr) return step_in_work(edit) ? outcome_of(edit.steps.back()) : model;
  if (is_ready(*step)) return outcome_of(edit.steps.back());
  document["steps"].erase(document["steps"].size() - 1);
  return model;
}

// Returns the only part that no graft uses. Throws Error(input) where there is none or more than one.
std::string only_part(const EditFile& edit) {
  std::vector<std::string> parts;
  for (const EditInput& input : edit.inputs)
    if (input.name != model_of(edit) && !is_grafted(edit, input.name)) parts.push_back(input.name);
  if (parts.size() == 1) return parts.front();
  if (parts.empty()) throw Error(facts::editor::NoPart{}, "source");
  throw Error(facts::editor::PartUnclear{.count = parts.size()}, "source");
}

void exchange(Json& object, const char* one, const char* other) {
  Json first = object.value(one, Json()), second = object.value(other, Json());
  for (const auto& [key, value] : {std::pair{one, &second}, std::pair{other, &first}}) {
    object.erase(key);
    if (!value->is_null()) object[key] = *value;
  }
}

void reverse_all(Json& matches) {
  for (Json& match : matches) std::swap(match[0], match[1]);
}

}  // namespace

void require_no_graft(const EditFile& edit, const std::string& what) {
  if (merge_in_work(edit) != nullptr) throw Error(facts::editor::GraftInWork{}, Location::field(what));
}

Json file_input(const fs::path& folder, const fs::path& file) {
  const fs::path relative = file.lexically_relative(folder);
  const bool is_below = !relative.empty() && *relative.begin() != "..";
  return {{"file", (is_below ? relative : file).string()}, {"sha256", sha256(read_file(file))}};
}

std::string add_part(Json& document, const EditFile& edit, const Json& input, const std::string& name,
                     bool may_number) {
  const std::string free = may_number ? free_name(edit, name) : name;
  if (is_taken(edit, free)) throw Error(facts::script::NameTaken{.name = name}, "name");
  document["inputs"][free] = input;
  return free;
}

void remove_part(Json& document, const EditFile& edit, const std::string& name) {
  if (name == model_of(edit)) throw Error(facts::editor::IsModel{.name = name}, "name");
  if (!is_taken(edit, name)) throw Error(facts::editor::PartNotAdded{.name = name}, "name");
  Json kept = Json::array();
  for (std::size_t i = 0; i < edit.steps.size(); ++i)
    if (!makes(edit.steps[i], name)) kept.push_back(document["steps"][i]);
  if (std::any_of(kept.begin(), kept.end(), [&](const Json& step) { return uses(step, name); }))
    throw Error(facts::editor::PartInUse{.name = name}, "name");
  document["steps"] = std::move(kept);
  document["inputs"].erase(name);
}

void edit_part(Json& document, const EditFile& edit, const std::string& name) {
  if (!is_taken(edit, name)) throw Error(facts::editor::NoSuchPart{.name = name}, "name");
  end_step_in_work(document, edit);
  document["steps"].push_back(empty_step(name));
}

std::size_t add_mesh_step(Json& document, const EditFile& edit, Json step) {
  Json& steps = document["steps"];
  const DeformStep* deform = deform_in_work(edit);
  if (deform != nullptr && step["mesh"] != deform->mesh && step["mesh"] != outcome_of(edit.steps.back())) {
    steps.insert(steps.end() - 1, std::move(step));  // the work on the model goes on
    return steps.size() - 2;
  }
  const bool of_model = step["mesh"] == model_of(edit);
  const Json before = steps.empty() ? Json() : steps.back();
  const std::string model = end_step_in_work(document, edit);
  if (of_model) step["mesh"] = model;
  const bool keeps_plane = step["kind"] != "transform";
  steps.push_back(std::move(step));
  Json next = empty_step(model);
  if (deform != nullptr) next["settings"] = before["settings"];
  if (keeps_plane && before.contains("symmetry")) next["symmetry"] = before["symmetry"];
  steps.push_back(std::move(next));
  return steps.size() - 2;
}

Halves add_halves(Json& document, const EditFile& edit, Json step) {
  Halves halves{.part = free_name(edit, step["mesh"])};
  step["keep"] = "below";
  step["result"] = halves.part;
  add_mesh_step(document, edit, step);
  const Document divided = make_document(document, edit.base_folder);
  document = divided.json;
  step["keep"] = "above";
  step.erase("result");
  halves.step = add_mesh_step(document, divided.edit, std::move(step));
  return halves;
}

bool is_grafted(const EditFile& edit, const std::string& name) {
  const std::size_t count = edit.steps.size() - (merge_in_work(edit) != nullptr ? 1 : 0);
  for (std::size_t i = 0; i < count; ++i)
    if (const auto* merge = std::get_if<MergeStep>(&edit.steps[i].action))
      if (merge->source == name) return true;
  return false;
}

void set_graft(Json& document, const EditFile& edit, const Json& fields) {
  if (merge_in_work(edit) == nullptr) {
    const std::string source =
        fields.contains("source") ? Json(fields["source"]).get<std::string>() : only_part(edit);
    const std::string model = end_step_in_work(document, edit);
    document["steps"].push_back({{"kind", "merge"}, {"target", model}, {"source", source}});
  }
  Json& step = document["steps"].back();
  for (const auto& [name, value] : fields.items())
    if (value.is_null())
      step.erase(name);
    else if (name == "settings" && value.is_object())
      replace_settings(step[name], value);
    else
      step[name] = value;
  for (const char* side : {"target", "source"})
    if (!step.contains(side)) throw Error(facts::editor::GraftSideMissing{}, side);
  if (step["target"] == step["source"]) throw Error(facts::editor::GraftedOntoItself{}, "source");
}

void cancel_graft(Json& document, const EditFile& edit) {
  const MergeStep* merge = merge_in_work(edit);
  if (merge == nullptr) throw Error(facts::editor::NoGraft{}, "graft");
  Json& steps = document["steps"];
  steps.erase(steps.size() - 1);
  steps.push_back(empty_step(merge->target));
}

void resume_graft(Json& document, const EditFile& edit, std::optional<std::size_t> index) {
  const auto is_graft = [](const EditStep& step) { return std::holds_alternative<MergeStep>(step.action); };
  if (!index) {
    const auto last = std::find_if(edit.steps.rbegin(), edit.steps.rend(), is_graft);
    index = static_cast<std::size_t>(edit.steps.rend() - last) - 1;  // past all steps where there is none
  }
  if (merge_in_work(edit) != nullptr || *index >= edit.steps.size() || !is_graft(edit.steps[*index]))
    throw Error(facts::editor::NoGraftToResume{}, "graft");
  drop_steps_from(document, *index + 1);
}

std::vector<Json> ResumedGraft::set_aside() const {
  const Json& steps = before.json["steps"];
  std::vector<Json> later(steps.begin() + static_cast<std::ptrdiff_t>(after.edit.steps.size()), steps.end());
  const DeformStep* last = deform_in_work(before.edit);
  if (last != nullptr && !is_ready(*last)) later.pop_back();
  return later;
}

std::optional<ResumedGraft> resumed_graft(const Document& document, const History& history) {
  if (merge_in_work(document.edit) == nullptr) return std::nullopt;
  constexpr std::array other_beginnings{"start_graft", "drop_part", "accept", "cancel_graft", "reset"};
  for (std::size_t i = history.position(); i > 0; --i) {
    const std::string& label = history.at(i).label;
    if (std::ranges::find(other_beginnings, label) != other_beginnings.end()) break;
    if (label != "resume_graft") continue;
    const auto state = [&](std::size_t at) {
      return parse_document(history.at(at).document, document.edit.base_folder);
    };
    return ResumedGraft{state(i - 1), state(i)};
  }
  return std::nullopt;
}

Json with_later_steps(const Json& document, const ResumedGraft& resumed) {
  const auto& [before, after] = resumed;
  Json whole = document;
  for (std::size_t i = after.edit.steps.size(); i < before.edit.steps.size(); ++i)
    whole["steps"].push_back(before.json["steps"][i]);
  if (before.json.contains("output")) whole["output"] = before.json["output"];
  const Json none = Json::object();
  const Json all = before.json.value("selections", none), left = after.json.value("selections", none),
             now = document.value("selections", none);
  for (const auto& [name, selection] : all.items())
    if (!left.contains(name) && !now.contains(name)) whole["selections"][name] = selection;
  return whole;
}

Json cancelled_again(const Json& document, const ResumedGraft& resumed) {
  const auto& [before, after] = resumed;
  const std::size_t graft = after.edit.steps.size() - 1;
  Json as_resumed = document;
  as_resumed["steps"].back() = after.json["steps"][graft];
  if (as_resumed == after.json) return before.json;
  Json kept = document;
  kept["steps"].back() = before.json["steps"][graft];
  return with_later_steps(kept, resumed);
}

std::string part_of_last_change(const History& history) {
  if (!history.can_undo() || history.label() != "add_part") return {};
  const Json before = Json::parse(history.before().document), now = Json::parse(history.current());
  for (const auto& [name, input] : now["inputs"].items())
    if (!before["inputs"].contains(name)) return name;
  return {};
}

std::string part_of_drop(const History& history) {
  for (std::size_t i = history.position(); i > 0; --i) {
    if (history.at(i).label == "start_graft") break;
    if (history.at(i).label == "drop_part")
      return Json::parse(history.at(i).document)["steps"].back()["source"].get<std::string>();
  }
  return {};
}

void swap_graft(Json& document, const EditFile& edit) {
  if (merge_in_work(edit) == nullptr) throw Error(facts::editor::NoGraft{}, "graft");
  Json& step = document["steps"].back();
  exchange(step, "target", "source");
  for (const char* field :
       {"at", "mirror", "source_transform", "align", "fixed", "reach", "features", "size", "result", "counts"})
    step.erase(field);
  if (step.contains("matches")) reverse_all(step["matches"]);
  if (!step.contains("pairs")) return;
  for (Json& pair : step["pairs"]) {
    exchange(pair, "source_loop", "target_loop");
    if (pair.contains("start")) std::swap(pair["start"][0], pair["start"][1]);
    if (pair.contains("matches")) reverse_all(pair["matches"]);
  }
}

}  // namespace meshgraft::editor
