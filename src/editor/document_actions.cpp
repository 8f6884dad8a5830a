#include "document_actions.h"

#include <algorithm>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "editor/facts.h"
#include "script/facts.h"

namespace meshgraft::editor {

namespace {

// Calls `visit` with each name of a selection that `selection` uses.
void for_each_name(Json& selection, const std::function<void(Json&)>& visit) {
  if (selection.is_string()) return visit(selection);
  if (!selection.is_object()) return;
  for (const char* kind : {"grow", "grow_length", "mirror", "rim"})
    if (selection.contains(kind)) for_each_name(selection[kind]["of"], visit);
  for (const char* kind : {"union", "minus", "intersect"})
    if (selection.contains(kind))
      for (Json& part : selection[kind]) for_each_name(part, visit);
}

void for_each_name_in_document(Json& document, const std::function<void(Json&)>& visit) {
  if (document.contains("selections"))
    for (Json& selection : document["selections"]) for_each_name(selection, visit);
  for (Json& step : document["steps"]) {
    for (const char* field : {"region", "fixed"})
      if (step.contains(field)) for_each_name(step[field], visit);
    for (const char* list : {"handles", "anchors", "features"})
      if (step.contains(list))
        for (Json& element : step[list]) for_each_name(element["select"], visit);
    if (step.contains("pairs"))
      for (Json& pair : step["pairs"])
        for (const char* loop : {"source_loop", "target_loop"}) for_each_name(pair[loop], visit);
  }
}

bool is_used(Json& document, const std::string& name) {
  bool used = false;
  for_each_name_in_document(document, [&](Json& found) { used = used || found == name; });
  return used;
}

void forget(Json& document, const std::string& name) {
  for (const char* field : {"selections", "colours"})
    if (document.contains(field)) document[field].erase(name);
}

Json& handle_of(Json& document, const std::string& name) {
  for (Json& handle : step_of(document)["handles"])
    if (handle["name"] == name) return handle;
  throw Error(facts::editor::NoSuchHandle{.handle = name}, "handle");
}

// Returns the selections whose union is the region; an empty list where the region is empty.
std::vector<Json> parts_of(const Json& region) {
  if (region.is_object() && region.contains("union")) return region["union"];
  if (region.is_object() && region.contains("indices") && region["indices"].empty()) return {};
  return {region};
}

Json region_of(const std::vector<Json>& parts) {
  if (parts.empty()) return {{"indices", Json::array()}};
  return parts.size() == 1 ? parts.front() : Json{{"union", parts}};
}

bool is_reach_of(const Json& part, const Json& selection) {
  return part.is_object() && part.contains("grow_length") && part["grow_length"]["of"] == selection;
}

std::string free_name(const Json& document, const Json& step, std::string name) {
  const auto taken = [&](const std::string& candidate) {
    const Json handles = step.value("handles", Json::array());
    return (document.contains("selections") && document["selections"].contains(candidate)) ||
           candidate == "all" ||
           std::any_of(handles.begin(), handles.end(), [&](const Json& h) { return h["name"] == candidate; });
  };
  const std::string stem = name.empty() ? "handle" : name;
  for (int number = name.empty() ? 1 : 2; name.empty() || taken(name); ++number)
    name = fmt::format("{} {}", stem, number);
  return name;
}

std::string outcome_of(const Json& step) {
  if (step.contains("result")) return step["result"];
  return step.contains("target") ? step["target"] : step["mesh"];
}

}  // namespace

Json empty_step(const std::string& mesh) {
  return {
      {"kind", "deform"}, {"mesh", mesh}, {"region", {{"indices", Json::array()}}}, {"handles", Json::array()}};
}

Json& step_of(Json& document) {
  Json& steps = document["steps"];
  if (steps.back()["kind"] == "merge") throw Error(facts::editor::GraftInWork{}, "deform");
  if (steps.back()["kind"] != "deform") steps.push_back(empty_step(outcome_of(steps.back())));
  Json& step = steps.back();
  if (!step.contains("region")) step["region"] = "all";
  if (!step.contains("handles")) step["handles"] = Json::array();
  return step;
}

std::string add_handle(Json& document, const NewHandle& added) {
  Json& step = step_of(document);
  Json handle = {{"name", added.name}, {"shape", added.shape}, {"select", added.select}};
  for (const Json& other : step["handles"])
    if (other["name"] == added.name) throw Error(facts::script::NameTaken{.name = added.name}, "name");
  if (added.name.empty()) handle["name"] = free_name(document, step, {});
  if (added.closed) handle["closed"] = *added.closed;
  if (!added.constrain.empty()) handle["constrain"] = added.constrain;
  if (!added.pose.empty()) handle["pose"] = added.pose;
  if (added.reach) {
    const std::string selection = free_name(document, step, handle["name"]);
    document["selections"][selection] = added.select;
    handle["select"] = selection;
    std::vector<Json> parts = parts_of(step["region"]);
    parts.push_back({{"grow_length", {{"of", selection}, {"length", *added.reach}}}});
    if (step["region"] != "all") step["region"] = region_of(parts);
  }
  step["handles"].push_back(handle);
  return handle["name"];
}

void remove_handle(Json& document, const std::string& name) {
  const Json select = handle_of(document, name)["select"];
  Json& step = step_of(document);
  std::erase_if(step["handles"].get_ref<Json::array_t&>(), [&](const Json& h) { return h["name"] == name; });
  if (!select.is_string()) return;
  std::vector<Json> parts = parts_of(step["region"]);
  std::erase_if(parts, [&](const Json& part) { return is_reach_of(part, select); });
  step["region"] = region_of(parts);
  if (select != "all" && !is_used(document, select)) forget(document, select);
}

void rename_handle(Json& document, const std::string& name, const std::string& to) {
  Json& handle = handle_of(document, name);
  handle["name"] = to;
  if (handle["select"] != name || name == "all" || document["selections"].contains(to)) return;
  document["selections"][to] = document["selections"][name];
  if (document.contains("colours") && document["colours"].contains(name))
    document["colours"][to] = document["colours"][name];
  forget(document, name);
  for_each_name_in_document(document, [&](Json& used) {
    if (used == name) used = to;
  });
}

void set_reach(Json& document, const std::string& name, double reach) {
  const Json select = handle_of(document, name)["select"];
  Json& region = step_of(document)["region"];
  std::vector<Json> parts = parts_of(region);
  for (Json& part : parts) {
    if (!is_reach_of(part, select)) continue;
    part["grow_length"]["length"] = reach;
    region = region_of(parts);
    return;
  }
  throw Error(facts::editor::HandleWithoutReach{.handle = name}, "handle");
}

void set_pose(Json& document, const std::string& name, const Json& pose) {
  handle_of(document, name)["pose"] = pose;
}

void set_symmetry(Json& document, const Json& symmetry) {
  if (symmetry.is_null())
    step_of(document).erase("symmetry");
  else
    step_of(document)["symmetry"] = symmetry;
}

std::optional<double> reach_of(const Json& step, const Json& handle) {
  for (const Json& part : parts_of(step.value("region", Json("all"))))
    if (is_reach_of(part, handle["select"])) return part["grow_length"]["length"].get<double>();
  return std::nullopt;
}

void replace_fields(Json& into, const Json& changes) {
  for (const auto& [name, value] : changes.items())
    if (value.is_null())
      into.erase(name);
    else
      into[name] = value;
}

void replace_settings(Json& settings, const Json& changes) {
  if (settings.is_null()) settings = Json::object();
  if (changes.contains("preset") && changes["preset"] != settings.value("preset", Json())) {
    Json kept = Json::object();
    for (const char* name : {"backend", "seed", "weld"})
      if (settings.contains(name)) kept[name] = settings[name];
    settings = std::move(kept);
  }
  replace_fields(settings, changes);
}

void change_settings(Json& document, const Json& changes) {
  replace_settings(step_of(document)["settings"], changes);
}

void accept_step(Json& document, const EditFile& edit) {
  const DeformStep* step = deform_in_work(edit);
  if (step != nullptr && !is_ready(*step)) throw Error(facts::editor::StepDoesNothing{}, "accept");
  const Json& last = document["steps"].back();
  Json next = empty_step(outcome_of(last));
  if (step != nullptr) next["settings"] = last["settings"];
  if (last.contains("symmetry")) next["symmetry"] = last["symmetry"];
  document["steps"].push_back(std::move(next));
}

void set_group(Json& document, const std::string& name, const Json& selection, const std::string& colour) {
  document["selections"][name] = selection;
  if (!colour.empty()) document["colours"][name] = colour;
}

void set_colour(Json& document, const std::string& name, const std::string& colour) {
  if (!document.contains("selections") || !document["selections"].contains(name))
    throw Error(facts::editor::NoSuchSelection{.name = name}, "name");
  if (!colour.empty())
    document["colours"][name] = colour;
  else if (document.contains("colours"))
    document["colours"].erase(name);
}

void remove_group(Json& document, const std::string& name) {
  if (is_used(document, name)) throw Error(facts::editor::SelectionInUse{.name = name}, "name");
  forget(document, name);
}

}  // namespace meshgraft::editor
