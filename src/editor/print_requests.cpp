// Requests that concern printing: the check before an export, and the size and place of a mesh.
#include <memory>

#include <meshgraft/core/error.h>

#include "editor/facts.h"
#include "graft_actions.h"
#include "script/vector_json.h"
#include "worker.h"

namespace meshgraft::editor {

namespace {

Json print_json(const PrintCheck& check) {
  return {{"size", vector_json<Json>(check.size)},
          {"area", check.area},
          {"volume", check.volume ? Json(*check.volume) : Json()},
          {"inside_out", check.inside_out},
          {"holes", check.holes},
          {"open_edges", check.open_edges.size()},
          {"non_manifold_edges", check.non_manifold_edges.size()},
          {"turned_edges", check.turned_edges.size()},
          {"intersections", check.intersections.size()},
          {"thinnest_wall", check.thinnest_wall ? Json(*check.thinnest_wall) : Json()},
          {"thin", check.thin.size()},
          {"overhanging", check.overhanging.size()},
          {"overhang_area", check.overhang_area}};
}

}  // namespace

Json Worker::print_check(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "mesh", "up", "overhang_deg", "least_wall"});
  PrintCheckOptions options;
  fields.optional("up", [&](const json::Value& v) { options.up = v.direction(); });
  fields.optional("overhang_deg", [&](const json::Value& v) { options.overhang_deg = v.number_in(0, 90); });
  fields.optional("least_wall", [&](const json::Value& v) { options.least_wall = v.non_negative_number(); });
  auto checked = std::make_unique<CheckedPrint>();
  checked->mesh = open_one().outcome_for(object_of(fields)->name, context).mesh;
  checked->check = check_print(checked->mesh, options, context);
  print_ = std::move(checked);
  return {{"print", print_json(print_->check)}};
}

Json Worker::transform(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "mesh", "pose"});
  const EditFile& edit = open_one().document().edit;
  require_no_graft(edit, "transform");
  Json document = open_one().document().json;
  add_mesh_step(
      document, edit,
      {{"kind", "transform"}, {"mesh", object_of(fields)->name}, {"pose", fields.required("pose").raw()}});
  return change("transform", document, context);
}

}  // namespace meshgraft::editor
