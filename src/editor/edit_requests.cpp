// Requests that concern the document and the way it is shown.
#include <algorithm>
#include <iterator>
#include <map>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "editor/facts.h"
#include "graft_actions.h"
#include "mesh_messages.h"
#include "script/parse_parts.h"
#include "selecting.h"
#include "worker.h"

namespace meshgraft::editor {

namespace {

std::vector<Index> vertices_of(const json::Value& value, const Object& base) {
  std::vector<Index> vertices = value.vertices();
  for (const Index v : vertices)
    if (v >= base.mesh().vertex_count())
      value.fail(facts::core::NoSuchVertex{.vertex = v, .count = base.mesh().vertex_count()});
  std::sort(vertices.begin(), vertices.end());
  vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
  return vertices;
}

template <class Operation>
std::vector<Index> combined(Operation&& operation, const std::vector<Index>& a, const std::vector<Index>& b) {
  std::vector<Index> out;
  operation(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(out));
  return out;
}

constexpr auto unite = [](auto... arguments) { std::set_union(arguments...); };
constexpr auto take_away = [](auto... arguments) { std::set_difference(arguments...); };
constexpr auto intersect = [](auto... arguments) { std::set_intersection(arguments...); };

// Returns all vertices that are not in `selection`.
std::vector<Index> inverted(const std::vector<Index>& selection, Index count) {
  std::vector<Index> all(count);
  for (Index v = 0; v < count; ++v) all[v] = v;
  return combined(take_away, all, selection);
}

// Grows a selection by rings. A negative number shrinks it, by growing the complement.
std::vector<Index> grown(const std::vector<Index>& selection, int rings, const Object& base) {
  const IndexLists& neighbours = base.selections->rings;
  if (rings >= 0) return grow_rings(selection, rings, neighbours);
  const Index count = base.mesh().vertex_count();
  return inverted(grow_rings(inverted(selection, count), -rings, neighbours), count);
}

// Reach of a new handle, × the model's diagonal: far enough to bend softly.
constexpr double default_reach = 0.15;

std::vector<Index> held_already(const LiveView& view) {
  std::vector<Index> held;
  for (const ShownHandle& shown : view.handles())
    held.insert(held.end(), shown.handle.vertices.begin(), shown.handle.vertices.end());
  std::sort(held.begin(), held.end());
  return held;
}

Json indices(const std::vector<Index>& vertices) { return {{"indices", vertices}}; }

}  // namespace

// Returns the field `select` in the form of an edit file; without it, the page's selection on the object
// `on`.
Json Worker::selection_or(const json::Object& fields, const std::string& on) {
  if (fields.has("select")) return fields.required("select").raw();
  return selected_on(on);
}

Json Worker::selected_on(const std::string& name) {
  const Workspace::PageSelection& selection = open_one().selection;
  if (selection.vertices.empty()) throw Error(facts::editor::NothingSelected{}, "select");
  if (selection.on->name != name)
    throw Error(facts::editor::SelectedElsewhere{.on = selection.on->name, .wanted = name}, "select");
  return indices(selection.vertices);
}

Json Worker::select(const json::Value& message, const Context&) {
  enum class How { set, add, remove, intersect, invert, grow };
  const json::Object fields(message, {"id", "do", "mesh", "how", "what", "rings"});
  Workspace& workspace = open_one();
  const std::shared_ptr<const Object> object = object_of(fields);
  const Object& base = *object;
  std::vector<Index> selection;
  if (workspace.selection.on == object) selection = workspace.selection.vertices;
  const How how = fields.required("how").choice<How>({{"set", How::set},
                                                      {"add", How::add},
                                                      {"remove", How::remove},
                                                      {"intersect", How::intersect},
                                                      {"invert", How::invert},
                                                      {"grow", How::grow}});
  std::vector<Index> named;
  if (how != How::invert && how != How::grow)
    named = select_vertices(fields.required("what"), workspace.document(), base, shared_.folders);
  switch (how) {
    case How::set: selection = std::move(named); break;
    case How::add: selection = combined(unite, selection, named); break;
    case How::remove: selection = combined(take_away, selection, named); break;
    case How::intersect: selection = combined(intersect, selection, named); break;
    case How::invert: selection = inverted(selection, base.mesh().vertex_count()); break;
    case How::grow:
      selection = grown(selection, static_cast<int>(fields.required("rings").integer_in(-1000, 1000)), base);
      break;
  }
  outbox_.send(selection_frame(base, selection), "selection");
  workspace.selection = {object, std::move(selection)};
  return {{"selected", workspace.selection.vertices.size()}};
}

Json Worker::group(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "name", "select", "colour", "remove", "keep"});
  const std::string name = fields.required("name").name();
  bool removes = false, keeps = false;
  std::string colour;
  fields.optional("remove", [&](const json::Value& v) { removes = v.boolean(); });
  fields.optional("keep", [&](const json::Value& v) { keeps = v.boolean(); });
  fields.optional("colour", [&](const json::Value& v) { colour = v.name(); });
  Json document = open_one().document().json;
  if (removes) {
    if (const auto resumed = resumed_graft(open_one().document(), open_one().history())) {
      Json before = resumed->before.json;  // Cancel needs the selections that it uses
      remove_group(before, name);
    }
    remove_group(document, name);
  } else if (keeps) {
    set_colour(document, name, colour);
  } else {
    set_group(document, name, selection_or(fields, open_one().selection.on->name), colour);
  }
  return change(removes ? "remove_group" : keeps ? "colour" : "group", document, context);
}

Json Worker::paint_handle(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "vertices", "reach", "name"});
  Workspace& workspace = open_one();
  const Object& base = workspace.view().base();
  require_no_graft(workspace.document().edit, "paint-handle");
  const std::vector<Index> vertices =
      combined(take_away, vertices_of(fields.required("vertices"), base), held_already(workspace.view()));
  if (vertices.empty()) message.fail(facts::editor::HeldAlready{});
  NewHandle handle;
  handle.shape = vertices.size() == 1 ? "vertex" : "region";
  handle.select = indices(vertices);
  handle.reach = default_reach * base.diagonal;
  fields.optional("reach", [&](const json::Value& v) { handle.reach = v.positive_number(); });
  fields.optional("name", [&](const json::Value& v) { handle.name = v.name(); });
  handle.pose = workspace.view().pose_as_shown(vertices);
  Json document = workspace.document().json;
  const std::string name = add_handle(document, handle);
  return change("paint_handle", document, context, {{"name", name}, {"reach", *handle.reach}});
}

Json Worker::reach(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "handle", "reach"});
  Json document = open_one().document().json;
  set_reach(document, fields.required("handle").name(), fields.required("reach").positive_number());
  return change("reach", document, context);
}

Json Worker::region(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "select"});
  Json document = open_one().document().json;
  step_of(document)["region"] = selection_or(fields, model_name());
  return change("region", document, context);
}

Json Worker::fixed(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "select", "rim"});
  Json document = open_one().document().json;
  bool is_rim = false;
  fields.optional("rim", [&](const json::Value& v) { is_rim = v.boolean(); });
  if (is_rim)
    step_of(document).erase("fixed");
  else
    step_of(document)["fixed"] = selection_or(fields, model_name());
  return change("fixed", document, context);
}

Json Worker::handle(const json::Value& message, const Context& context) {
  enum class What { add, remove, rename };
  const json::Object fields(
      message, {"id", "do", "what", "name", "to", "shape", "closed", "constrain", "select", "reach"});
  const What what = fields.required("what").choice<What>(
      {{"add", What::add}, {"remove", What::remove}, {"rename", What::rename}});
  Json document = open_one().document().json;
  if (what == What::remove) {
    remove_handle(document, fields.required("name").name());
    return change("remove_handle", document, context);
  }
  if (what == What::rename) {
    rename_handle(document, fields.required("name").name(), fields.required("to").name());
    return change("rename_handle", document, context);
  }
  NewHandle added;
  added.shape = "region";
  added.select = selection_or(fields, model_name());
  fields.optional("name", [&](const json::Value& v) { added.name = v.name(); });
  fields.optional("shape", [&](const json::Value& v) { added.shape = v.name(); });
  fields.optional("closed", [&](const json::Value& v) { added.closed = v.boolean(); });
  fields.optional("constrain", [&](const json::Value& v) { added.constrain = v.name(); });
  fields.optional("reach", [&](const json::Value& v) { added.reach = v.positive_number(); });
  const LiveView& view = open_one().view();
  added.pose = view.pose_as_shown(select_vertices(json::Value(added.select, "select"), open_one().document(),
                                                  view.base(), shared_.folders));
  const std::string name = add_handle(document, added);
  return change("add_handle", document, context, {{"name", name}});
}

Json Worker::drag(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do", "poses", "frames"});
  LiveView& view = open_one().view();
  const json::Value given = fields.required("poses");
  if (!given.is_object()) given.fail(facts::editor::PosesExpected{});
  std::map<std::string, PoseSpec> poses;
  for (const auto& [name, pose] : given.raw().items())
    poses[name] = parse_pose(given.member(name), view.shape_of(name));
  bool exact_alone = false;
  fields.optional(
      "frames", [&](const json::Value& v) { exact_alone = v.choice<bool>({{"all", false}, {"exact", true}}); });
  return {{"pose", view.drag(poses, exact_alone)}};
}

Json Worker::pose(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "poses"});
  const json::Value given = fields.required("poses");
  if (!given.is_object()) given.fail(facts::editor::PosesExpected{});
  Json document = open_one().document().json;
  for (const auto& [name, pose] : given.raw().items()) set_pose(document, name, pose);
  return change("pose", document, context);
}

Json Worker::settings(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "settings", "anchors"});
  Json document = open_one().document().json;
  fields.optional("settings", [&](const json::Value& v) {
    if (!v.is_object()) v.fail_type(facts::script::Type::object);
    change_settings(document, v.raw());
  });
  fields.optional("anchors", [&](const json::Value& v) { step_of(document)["anchors"] = v.raw(); });
  return change("settings", document, context);
}

Json Worker::accept(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do"});
  Json document = open_one().document().json;
  if (open_one().steps_set_aside().empty())
    accept_step(document, open_one().document().edit);
  else
    document = with_later_steps(document, *resumed_graft(open_one().document(), open_one().history()));
  open_one().finish(context);
  return change("accept", document, context);
}

Json Worker::undo(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do"});
  open_one().undo(context);
  return shown();
}

Json Worker::redo(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do"});
  open_one().redo(context);
  return shown();
}

Json Worker::reset(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do"});
  open_one().reset(context);
  return shown();
}

Json Worker::leave_set_up(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "of"});
  open_one().leave_set_up(context);
  return shown();
}

Json Worker::state(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do"});
  return open_one().summary();
}

}  // namespace meshgraft::editor
