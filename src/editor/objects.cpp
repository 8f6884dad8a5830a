#include "objects.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "editor/facts.h"
#include "graft_messages.h"
#include "script/sha256.h"

namespace meshgraft::editor {

namespace {

void collect_words(const Json& json, std::set<std::string>& words) {
  if (json.is_string()) words.insert(json.get<std::string>());
  if (json.is_structured())
    for (const Json& part : json) collect_words(part, words);
}

void find_box(Object& base) {
  Eigen::RowVector3d least = Eigen::RowVector3d::Zero(), most = least;
  bool any = false;
  for (const auto& point : base.mesh().positions.rowwise()) {
    if (!point.allFinite()) continue;
    least = any ? least.cwiseMin(point).eval() : point.eval();
    most = any ? most.cwiseMax(point).eval() : point.eval();
    any = true;
  }
  base.offset = (least + most) / 2;
  base.diagonal = (most - least).norm();
}

void find_selections(Object& base) {
  const MeshState& state = base.state();
  const Finding* torn = state.diagnostics.find(FindingKind::duplicate_vertex);
  if (torn != nullptr && !state.is_cut) base.weld = weld_at(state.mesh, torn->indices);
  if (!base.weld.empty()) base.welded = welded(state.mesh, base.weld);
  base.selections.emplace(base.weld.empty() ? state.mesh : base.welded, base.weld);
  base.loops = base.weld.empty() ? base.selections->loops : boundary_loops(state.mesh);
}

// Folder names need not be valid UTF-8.
std::string key_of(const Json& made_from) {
  return sha256(made_from.dump(-1, ' ', false, Json::error_handler_t::replace));
}

// Returns the names of the meshes that a step starts from.
std::vector<std::string> meshes_of(const EditStep& step) {
  std::vector<std::string> names{mesh_of(step)};
  if (const auto* merge = std::get_if<MergeStep>(&step.action)) names.push_back(merge->source);
  return names;
}

// Returns the names of all meshes after the first `count` steps, inputs first.
std::vector<std::string> names_after(const EditFile& edit, std::size_t count) {
  std::vector<std::string> names;
  for (const EditInput& input : edit.inputs) names.push_back(input.name);
  for (std::size_t i = 0; i < count; ++i)
    if (std::find(names.begin(), names.end(), outcome_of(edit.steps[i])) == names.end())
      names.push_back(outcome_of(edit.steps[i]));
  return names;
}

}  // namespace

Json selections_used(const Json& document, const Json& json) {
  Json used = Json::object();
  if (!document.contains("selections")) return used;
  std::set<std::string> words;
  collect_words(json, words);
  for (bool grew = true; grew;) {
    grew = false;
    for (const auto& [name, selection] : document["selections"].items()) {
      if (used.contains(name) || !words.contains(name)) continue;
      used[name] = selection;
      collect_words(selection, words);
      grew = true;
    }
  }
  return used;
}

const std::shared_ptr<const Object>& StepInputs::named(const std::string& name) const {
  if (model->name == name) return model;
  for (const auto& part : parts)
    if (part->name == name) return part;
  throw Error(facts::editor::NoSuchPart{.name = name}, "mesh");
}

struct Objects::Keys {
  std::string folder;
  std::vector<std::string> steps;
  const Document& document;

  explicit Keys(const Document& document_) : folder(document_.edit.base_folder.string()), document(document_) {
    const auto& all = document.edit.steps;
    for (std::size_t i = 0; i < all.size(); ++i) {
      const Json& step = document.json["steps"][i];
      Json made_from = {step, selections_used(document.json, step), folder};
      for (const std::string& name : meshes_of(all[i])) made_from.push_back(of(name, i));
      steps.push_back(key_of(made_from));
    }
  }

  std::optional<std::size_t> maker(const std::string& name, std::size_t count) const {
    while (count > 0)
      if (outcome_of(document.edit.steps[--count]) == name) return count;
    return std::nullopt;
  }

  std::string of(const std::string& name, std::size_t count) const {
    if (const auto step = maker(name, count)) return steps[*step];
    return key_of({document.json["inputs"][name], folder});
  }
};

std::vector<std::string> Objects::step_keys(const Document& document) { return Keys(document).steps; }

std::shared_ptr<const MeshState> Objects::input(const Document& document, const std::string& name,
                                                const Keys& keys, const Context& context) {
  const std::string key = keys.of(name, 0);
  if (auto known = inputs_.find(key)) return known;
  EditFile alone = document.edit;
  std::erase_if(alone.inputs, [&](const EditInput& one) { return one.name != name; });
  auto read = std::make_shared<const MeshState>(std::move(load_inputs(alone, context).states.at(name)));
  inputs_.put(key, read);
  return read;
}

std::shared_ptr<const MeshState> Objects::state(const Document& document, const std::string& name,
                                                std::size_t count, const Keys& keys, const Context& context) {
  const std::optional<std::size_t> maker = keys.maker(name, count);
  if (!maker) return input(document, name, keys, context);
  const std::string& key = keys.steps[*maker];
  if (auto known = states_.find(key)) return known;
  const EditStep& step = document.edit.steps[*maker];
  std::map<std::string, MeshState> states;
  for (const std::string& used : meshes_of(step))
    states.insert_or_assign(used, *state(document, used, *maker, keys, context));
  const RunningSteps::Mark mark = running_.begin(key);
  const StepReport report = run_step(
      document.edit, step, (Location::file(document.edit.location) / "steps")[*maker], states, {}, context);
  if (report.merge) found_.put(key, std::make_shared<const Json>(found_json(*report.merge)));
  if (report.sculpt) found_.put(key, std::make_shared<const Json>(found_json(*report.sculpt, report.notes)));
  if (report.cut) found_.put(key, std::make_shared<const Json>(found_json(*report.cut, report.notes)));
  if (report.repair) found_.put(key, std::make_shared<const Json>(found_json(*report.repair, report.notes)));
  auto made = std::make_shared<const MeshState>(std::move(states.at(name)));
  states_.put(key, made);
  return made;
}

std::shared_ptr<const Object> Objects::object(const std::string& name, const std::string& key,
                                              std::shared_ptr<const MeshState> state) {
  if (auto known = objects_.find(name + key)) return known;
  const auto made = std::make_shared<Object>();
  made->name = name;
  made->shared_state = std::move(state);
  made->id = static_cast<int>(numbers_.next());
  find_box(*made);
  find_selections(*made);
  Triangulation surface = triangulate(made->mesh(), {.skip_out_of_range = true});
  made->triangles = std::move(surface.triangles);
  made->triangle_faces = std::move(surface.face);
  objects_.put(name + key, made);
  return made;
}

StepInputs Objects::before(const Document& document, const Context& context) {
  const EditFile& edit = document.edit;
  const std::size_t count = step_in_work(edit).value_or(edit.steps.size());
  const Keys keys(document);
  const std::string model = model_of(edit);
  StepInputs stage;
  for (const std::string& name : names_after(edit, count)) {
    auto found = object(name, keys.of(name, count), state(document, name, count, keys, context));
    if (name == model)
      stage.model = std::move(found);
    else
      stage.parts.push_back(std::move(found));
  }
  for (std::size_t i = 0; i < count; ++i) {
    const auto found = found_.find(keys.steps[i]);
    stage.found.push_back(found ? *found : Json());
  }
  constexpr std::size_t most_undone = 3;
  constexpr std::size_t most_found = 64;  // they are small, and come back with steps that were set aside
  found_.keep(count + most_found);
  const std::size_t most = stage.parts.size() + 1 + most_undone;
  inputs_.keep(edit.inputs.size() + most_undone);
  states_.keep(most);
  objects_.keep(most);
  return stage;
}

std::shared_ptr<const MeshState> Objects::after(const Document& document, std::size_t count,
                                                const std::string& name, const Context& context) {
  return state(document, name, count, Keys(document), context);
}

void Objects::learn(const Document& document, StepOutcome outcome) {
  const std::string key = Keys(document).steps.back();
  if (states_.find(key)) return;
  states_.put(key, std::move(outcome.state));
  if (!outcome.found.is_null()) found_.put(key, std::make_shared<const Json>(std::move(outcome.found)));
}

}  // namespace meshgraft::editor
