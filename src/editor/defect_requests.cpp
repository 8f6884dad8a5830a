// Requests that concern the defects of a mesh.
#include <algorithm>
#include <vector>

#include <meshgraft/core/error.h>

#include "defects.h"
#include "editor/facts.h"
#include "graft_actions.h"
#include "marks.h"
#include "mesh/repair/repair_kinds.h"
#include "script/facts.h"
#include "script/settings_json.h"
#include "worker.h"

namespace meshgraft::editor {

namespace {

std::vector<FindingKind> all_repairable(const Object& object) {
  std::vector<FindingKind> kinds;
  for (const Finding& finding : object.state().diagnostics.findings)
    if (matters(finding) && is_repairable(finding.kind)) kinds.push_back(finding.kind);
  return kinds;
}

std::vector<FindingKind> kinds_in(const json::Value& list, const Object& object) {
  std::vector<FindingKind> kinds;
  if (list.size() == 0) list.fail(facts::script::EmptyList{.what = facts::script::Element::element});
  for (std::size_t i = 0; i < list.size(); ++i) kinds.push_back(finding_named(object, list[i].name()).kind);
  return kinds;
}

// Returns the fields of a repair that removes all findings. Seams that a cut opened stay open.
Json whole_repair(const Object& object) {
  RepairOptions options;
  options.weld = !object.state().is_cut;
  return settings_json(options);
}

}  // namespace

Json Worker::mark(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do", "mesh", "finding"});
  const std::shared_ptr<const Object> object = object_of(fields);
  const Marks marks = marks_of(*object, finding_named(*object, fields.required("finding").name()));
  outbox_.send(marks_frame(*object, marks));
  return {{"marked", marks.points.size() + marks.lines.size() / 2 + marks.triangles.size() / 3}};
}

Json Worker::repair(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "mesh", "kinds"});
  const EditFile& edit = open_one().document().edit;
  require_no_graft(edit, "repair");
  const std::shared_ptr<const Object> object = object_of(fields);
  if (all_repairable(*object).empty()) throw Error(facts::editor::NothingToRepair{}, "repair");
  Json step = {{"kind", "repair"}, {"mesh", object->name}};
  step.update(whole_repair(*object));
  fields.optional("kinds", [&](const json::Value& list) {
    step.update(Json(settings_json(repair_for(kinds_in(list, *object)))));
  });
  Json document = open_one().document().json;
  const std::size_t index = add_mesh_step(document, edit, std::move(step));
  Json result = change("repair", document, context);
  result["notes"] = open_one().stage().found.at(index)["changes"];
  return result;
}

}  // namespace meshgraft::editor
