// Requests that concern whole steps, and fields that apply to a whole step.
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

#include "editor/facts.h"
#include "graft_actions.h"
#include "script/fact_json.h"
#include "step_actions.h"
#include "worker.h"

namespace meshgraft::editor {

namespace {

// Returns the plane through the centre of the model's bounding box, across the x axis.
Json default_plane(const Object& base) {
  return {{"point", {base.offset.x(), base.offset.y(), base.offset.z()}}, {"normal", {1, 0, 0}}};
}

Json object_in(const json::Object& fields, std::string_view name) {
  Json object = Json::object();
  fields.optional(name, [&](const json::Value& value) {
    if (!value.is_object()) value.fail_type(facts::script::Type::object);
    object = value.raw();
  });
  return object;
}

// Returns whether a step of the document moved no vertex.
bool moved_nothing(const StepInputs& stage, std::size_t index, double diagonal) {
  constexpr double least_rel = 1e-9;  // × the diagonal
  const Json& found = stage.found.at(index);
  return found.is_object() && found.value("moved", 0.0) <= least_rel * diagonal;
}

}  // namespace

Json Worker::symmetry(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "plane", "tolerance_rel"});
  Workspace& workspace = open_one();
  Json document = workspace.document().json;
  Json plane = default_plane(workspace.view().base());
  fields.optional("plane", [&](const json::Value& value) {
    if (!value.is_null()) json::Object(value, {"point", "normal"});
    plane = value.raw();
  });
  if (!plane.is_null())
    fields.optional("tolerance_rel",
                    [&](const json::Value& value) { plane["tolerance_rel"] = value.positive_number(); });
  set_symmetry(document, plane);
  return change(plane.is_null() ? "symmetry_off" : "symmetry", document, context);
}

// Throws Error(usage) where the step is not the graft that is edited again, whose Accept and Cancel need all
// else as it was. `changes`: the step keeps its place and its name.
void Worker::require_graft_alone(bool changes, std::size_t index) {
  const Document& current = open_one().document();
  if (!resumed_graft(current, open_one().history())) return;
  if (const std::size_t count = open_one().steps_set_aside().size();
      count > 0 && !changes && index + 1 == current.edit.steps.size())
    throw Error(facts::editor::StepsSetAside{.count = count}, "index");
  if (!changes || index + 1 < current.edit.steps.size()) throw Error(facts::editor::StepBesideGraft{}, "index");
}

Json Worker::step(const json::Value& message, const Context& context) {
  enum class What { change, remove, rename };
  const json::Object fields(message, {"id", "do", "what", "index", "fields", "poses", "twist", "name"});
  const What what = fields.required("what").choice<What>(
      {{"change", What::change}, {"remove", What::remove}, {"rename", What::rename}});
  const auto index = static_cast<std::size_t>(fields.required("index").vertex());
  Json document = open_one().document().json;
  require_graft_alone(what == What::change, index);
  switch (what) {
    case What::change:
      change_step(document, index, {object_in(fields, "fields"), object_in(fields, "poses")});
      fields.optional("twist", [&](const json::Value& value) {
        const json::Object twist(value, {"pair", "by_deg"});
        const auto pair = static_cast<std::size_t>(twist.required("pair").vertex());
        set_start(document, index, pair,
                  open_one().twisted_start(index, pair, twist.required("by_deg").number(), context));
      });
      return change("change_step", document, context);
    case What::remove: remove_step(document, index); return change("remove_step", document, context);
    case What::rename: break;
  }
  rename_step(document, index, fields.required("name").string());
  return change("rename_step", document, context);
}

// With symmetry, the step shapes the mirror image of the region, too.
Json Worker::sculpt(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "action", "select", "strength", "height", "reach"});
  const EditFile& edit = open_one().document().edit;
  require_no_graft(edit, "sculpt");
  const std::shared_ptr<const Object> base = open_one().stage().model;
  Json document = open_one().document().json;
  Json step = {{"kind", "sculpt"}, {"mesh", base->name}, {"region", selection_or(fields, base->name)}};
  for (const char* field : {"action", "strength", "height", "reach"})
    fields.optional(field, [&](const json::Value& v) { step[field] = v.raw(); });
  if (const DeformStep* deform = deform_in_work(edit); deform != nullptr && deform->symmetry)
    step["symmetry"] = document["steps"].back()["symmetry"];
  const std::size_t index = add_mesh_step(document, edit, std::move(step));
  Json result = change("sculpt", document, context);
  result["notes"] = open_one().stage().found.at(index)["notes"];
  if (moved_nothing(open_one().stage(), index, base->diagonal))
    result["notes"].emplace_back(to_json(Note(facts::editor::NothingMoved{})));
  return result;
}

}  // namespace meshgraft::editor
