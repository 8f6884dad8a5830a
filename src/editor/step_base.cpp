#include "step_base.h"

#include <algorithm>
#include <set>

#include <fmt/format.h>

namespace meshgraft::editor {

namespace {

constexpr std::size_t most_bases = 3, most_finished = 2;

void collect_words(const Json& json, std::set<std::string>& words) {
  if (json.is_string()) words.insert(json.get<std::string>());
  if (json.is_structured())
    for (const Json& part : json) collect_words(part, words);
}

void find_box(StepBase& base) {
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

void find_selections(StepBase& base) {
  const Scene& scene = base.scene();
  const Finding* torn = scene.triage.find("duplicate-vertex");
  if (torn != nullptr && !scene.is_cut) base.weld = weld_at(scene.mesh, torn->indices);
  if (!base.weld.empty()) base.welded = welded(scene.mesh, base.weld);
  base.selections.emplace(base.weld.empty() ? scene.mesh : base.welded, base.weld);
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

namespace {

// All that the outcome of the first `count` steps depends on.
Json key_of_steps(const Document& document, std::size_t count) {
  Json steps = Json::array();
  for (std::size_t i = 0; i < count; ++i) steps.push_back(document.json["steps"][i]);
  return {document.json["inputs"], document.edit.base_folder.string(), steps,
          selections_used(document.json, steps)};
}

}  // namespace

const LoadedInputs& StepBases::inputs_of(const Document& document, const Context& context) {
  const Json key = {document.json["inputs"], document.edit.base_folder.string()};
  if (!inputs_ || inputs_key_ != key) {
    inputs_ = load_inputs(document.edit, context);
    inputs_key_ = key;
  }
  return *inputs_;
}

StepBases::Scenes StepBases::known_after(const Json& key) const {
  for (const Finished& finished : finished_)
    if (finished.key == key) return finished.scenes;
  for (const Known& known : known_)
    if (known.key[0] == key) return {known.base, &known.base->scenes};
  return nullptr;
}

StepBases::Scenes StepBases::after(const Document& document, std::size_t count, const Context& context) {
  Scenes known;
  std::size_t done = count;
  while ((known = known_after(key_of_steps(document, done))) == nullptr && done > 0) --done;
  if (known && done == count) return known;
  const EditFile& edit = document.edit;
  const auto scenes =
      std::make_shared<std::map<std::string, Scene>>(known ? *known : inputs_of(document, context).scenes);
  for (std::size_t i = done; i < count; ++i)
    run_step(edit, edit.steps[i], fmt::format("{}: steps[{}]", edit.place, i), *scenes,
             {.estimate_condition = false}, context);
  return scenes;
}

void StepBases::remember(const Document& document, Scenes scenes) {
  finished_.push_back({key_of_steps(document, document.edit.steps.size()), std::move(scenes)});
  if (finished_.size() > most_finished) finished_.pop_front();
}

std::shared_ptr<const StepBase> StepBases::before(const Document& document, const Context& context) {
  const EditFile& edit = document.edit;
  const std::size_t count = step_in_work(edit).value_or(edit.steps.size());
  const std::string mesh_name =
      count < edit.steps.size() ? mesh_of(edit.steps[count]) : outcome_of(edit.steps.back());
  const Json key = {key_of_steps(document, count), mesh_name};
  for (const Known& known : known_)
    if (known.key == key) return known.base;

  const auto base = std::make_shared<StepBase>();
  base->scenes = *after(document, count, context);
  base->mesh_name = mesh_name;
  base->id = ++last_id_;
  find_box(*base);
  find_selections(*base);
  base->triangles = triangulate(base->mesh(), {.skip_out_of_range = true}).triangles;
  known_.push_back({key, base});
  if (known_.size() > most_bases) known_.pop_front();
  return base;
}

}  // namespace meshgraft::editor
