// Requests that concern the defects of a mesh.
#include <algorithm>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/repair.h>

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

constexpr Index most_hole_edges = 100'000;  // as in an edit file

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

// Returns the options of a repair that closes all holes, after it joined what lies together.
RepairOptions repair_of_holes() {
  RepairOptions options = repair_for({});
  options.weld = true;
  options.hole_edges = most_hole_edges;
  options.hole_fill = HoleFill::faired;
  return options;
}

PrintFinding parse_print_finding(const json::Value& value) {
  using enum PrintFinding;
  return value.choice<PrintFinding>({{"open-edges", open_edges},
                                     {"non-manifold-edges", non_manifold_edges},
                                     {"turned-edges", turned_edges},
                                     {"intersections", intersections},
                                     {"thin-walls", thin_walls},
                                     {"overhangs", overhangs}});
}

}  // namespace

Json Worker::mark(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do", "mesh", "finding", "print"});
  require_one_of(message, {"finding", "print"});
  const std::shared_ptr<const Object> object = object_of(fields);
  Marks marks;
  fields.optional("finding",
                  [&](const json::Value& v) { marks = marks_of(*object, finding_named(*object, v.name())); });
  fields.optional("print", [&](const json::Value& v) {
    if (!print_) throw Error(facts::editor::NoPrintCheck{}, "print");
    marks = marks_of(print_->mesh, print_->check, parse_print_finding(v));
  });
  outbox_.send(marks_frame(*object, marks));
  return {{"marked", marks.points.size() + marks.lines.size() / 2 + marks.triangles.size() / 3}};
}

Json Worker::repair(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "mesh", "kinds", "holes"});
  const EditFile& edit = open_one().document().edit;
  require_no_graft(edit, "repair");
  const std::shared_ptr<const Object> object = object_of(fields);
  bool holes = false;
  fields.optional("holes", [&](const json::Value& v) { holes = v.boolean(); });
  if (holes ? object->loops.empty() : all_repairable(*object).empty())
    throw Error(facts::editor::NothingToRepair{}, "repair");
  Json step = {{"kind", "repair"}, {"mesh", object->name}};
  RepairOptions options;
  fields.optional("kinds", [&](const json::Value& list) { options = repair_for(kinds_in(list, *object)); });
  if (holes) options = repair_of_holes();
  if (object->state().is_cut) {  // what a cut opened stays open
    options.weld = false;
    if (!holes) options.hole_edges = 0;
  }
  // The border of a sheet is a loop, too, but no hole. A step that changes nothing would only be in the way.
  if (holes && !meshgraft::repair(object->mesh(), options, context).changed())
    return shown({{"notes", Json::array()}});
  step.update(Json(settings_json(options)));
  Json document = open_one().document().json;
  const std::size_t index = add_mesh_step(document, edit, std::move(step));
  Json result = change("repair", document, context);
  result["notes"] = open_one().stage().found.at(index)["changes"];
  return result;
}

}  // namespace meshgraft::editor
