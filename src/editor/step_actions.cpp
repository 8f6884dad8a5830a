#include "step_actions.h"

#include <algorithm>
#include <array>
#include <iterator>
#include <set>

#include <meshgraft/core/error.h>

#include "document_actions.h"
#include "editor/facts.h"

namespace meshgraft::editor {

namespace {

Json& step_at(Json& document, std::size_t index) {
  Json& steps = document["steps"];
  if (index >= steps.size())
    throw Error(facts::editor::NoSuchStep{.step = index + 1, .count = steps.size()}, "index");
  return steps[index];
}

// Renames the producer in every {"produced": {"step", "what"}}, at any depth.
void rename_producer(Json& json, const Json& from, const std::string& to) {
  if (!json.is_structured()) return;
  if (json.is_object() && json.contains("produced") && json["produced"].is_object() &&
      json["produced"].value("step", Json()) == from)
    json["produced"]["step"] = to;
  for (Json& part : json) rename_producer(part, from, to);
}

// Returns whether a selection contains {"produced": {"step", "what"}} of one of the steps, at any depth.
bool is_produced_by(const Json& json, const std::set<std::string>& steps) {
  if (!json.is_structured()) return false;
  if (json.is_object() && json.contains("produced") && json["produced"].is_object() &&
      steps.contains(json["produced"].value("step", std::string())))
    return true;
  return std::ranges::any_of(json, [&](const Json& part) { return is_produced_by(part, steps); });
}

// The fields in which the two cuts that divide an object agree.
constexpr std::array fields_of_both_halves{"mesh", "plane", "loop", "snap", "cap", "pins"};

bool is_other_half(const Json& one, const Json& other) {
  const auto is_alike = [&](const char* field) {
    return one.value(field, Json()) == other.value(field, Json());
  };
  if (one["kind"] != "cut" || other["kind"] != "cut") return false;
  const std::set<Json> sides{one.value("keep", Json()), other.value("keep", Json())};
  return sides == std::set<Json>{"above", "below"} && std::ranges::all_of(fields_of_both_halves, is_alike);
}

// Returns the cut of the other half, if the step is one of two cuts that divide an object; else null.
Json* other_half(Json& steps, std::size_t index) {
  for (const std::size_t other : {index + 1, index - 1})
    if (other < steps.size() && is_other_half(steps[index], steps[other])) return &steps[other];
  return nullptr;
}

// Makes changed fields of one cut those of the cut of the other half.
void change_other_half(Json& other, const Json& fields) {
  Json common = Json::object();
  for (const char* field : fields_of_both_halves)
    if (fields.contains(field)) common[field] = fields[field];
  replace_fields(other, common);
  const Json keep = fields.value("keep", Json());
  if (keep == "above" || keep == "below") other["keep"] = keep == "above" ? "below" : "above";
}

}  // namespace

void change_step(Json& document, std::size_t index, const StepChange& change) {
  Json& step = step_at(document, index);
  if (Json* other = other_half(document["steps"], index)) change_other_half(*other, change.fields);
  Json fields = change.fields;
  if (fields.contains("settings") && fields["settings"].is_object()) {
    replace_settings(step["settings"], fields["settings"]);
    fields.erase("settings");
  }
  replace_fields(step, fields);
  for (const auto& [name, pose] : change.poses.items()) {
    const auto is_meant = [&, wanted = name](const Json& handle) { return handle["name"] == wanted; };
    Json& handles = step["handles"];
    const auto handle = std::find_if(handles.begin(), handles.end(), is_meant);
    if (handle == handles.end())
      throw Error(facts::editor::NoHandleInStep{.step = index + 1, .handle = name}, "poses");
    (*handle)["pose"] = pose;
  }
}

void set_start(Json& document, std::size_t index, std::size_t pair, const Match& start) {
  Json& step = step_at(document, index);
  const Json match = {start.source, start.target};
  if (!step.contains("pairs")) {
    step["matches"] = Json::array({match});
    return;
  }
  Json& changed = step["pairs"].at(pair);
  changed["start"] = match;
  changed.erase("matches");
}

void remove_step(Json& document, std::size_t index) {
  step_at(document, index);
  if (document["steps"].size() == 1) throw Error(facts::editor::OnlyStep{}, "index");
  document["steps"].erase(index);
}

void drop_steps_from(Json& document, std::size_t first) {
  Json& steps = document["steps"];
  std::set<std::string> gone;
  for (std::size_t i = first; i < steps.size(); ++i)
    if (steps[i].contains("name")) gone.insert(steps[i]["name"]);
  steps.erase(steps.begin() + static_cast<std::ptrdiff_t>(first), steps.end());
  document.erase("output");
  if (!document.contains("selections")) return;
  Json& selections = document["selections"];
  for (auto one = selections.begin(); one != selections.end();)
    one = is_produced_by(*one, gone) ? selections.erase(one) : std::next(one);
}

void leave_out_steps(Json& document, std::size_t first, const std::string& mesh) {
  drop_steps_from(document, first);
  document["steps"].push_back(empty_step(mesh));
}

void rename_step(Json& document, std::size_t index, const std::string& name) {
  Json& step = step_at(document, index);
  const Json before = step.value("name", Json());
  if (name.empty())
    step.erase("name");
  else
    step["name"] = name;
  if (before.is_null() || name.empty()) return;
  for (const char* part : {"selections", "steps"})
    if (document.contains(part)) rename_producer(document[part], before, name);
}

}  // namespace meshgraft::editor
