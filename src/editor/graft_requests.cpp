// Requests that concern parts, cuts and grafts.
#include <algorithm>
#include <array>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

#include "editor/facts.h"
#include "graft_actions.h"
#include "graft_messages.h"
#include "mesh_messages.h"
#include "script/fact_json.h"
#include "script/facts.h"
#include "worker.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

constexpr std::array<std::string_view, 19> merge_fields = {
    "target",   "source",           "pose",        "shape", "pairs",   "matches",          "at",
    "mirror",   "source_transform", "align",       "size",  "fixed",   "normal_angle_deg", "reach",
    "features", "smooth_boundary",  "fix_winding", "retry", "settings"};

std::vector<std::string_view> graft_fields_and(std::initializer_list<std::string_view> others) {
  std::vector<std::string_view> names(merge_fields.begin(), merge_fields.end());
  names.insert(names.end(), others);
  return names;
}

// Returns the length of a loop and the centroid of its edges.
Json loop_json(const Points& points, const std::vector<Index>& loop) {
  double length = 0;
  Eigen::RowVector3d moment = Eigen::RowVector3d::Zero();
  for (std::size_t k = 0; k < loop.size(); ++k) {
    const Eigen::RowVector3d a = points.row(loop[k]), b = points.row(loop[(k + 1) % loop.size()]);
    length += (b - a).norm();
    moment += (b - a).norm() * (a + b) / 2;
  }
  const Eigen::RowVector3d centre = length > 0 ? (moment / length).eval() : points.row(loop.front()).eval();
  return {{"vertices", loop.size()}, {"length", length}, {"centre", {centre.x(), centre.y(), centre.z()}}};
}

}  // namespace

// Returns the object that the field `mesh` names; without the field, the model.
std::shared_ptr<const Object> Worker::object_of(const json::Object& fields) {
  std::string name;
  fields.optional("mesh", [&](const json::Value& v) { name = v.name(); });
  return open_one().object(name);
}

// Returns the file that the field `path` or `upload` names.
fs::path Worker::mesh_file(const json::Object& fields) {
  const fs::path asked = fields.has("upload")
                             ? shared_.upload_folder / fs::path(fields.required("upload").name()).filename()
                             : fs::path(fields.required("path").name());
  return shared_.folders.mesh_to_read(asked);
}

Json Worker::part(const json::Value& message, const Context& context) {
  enum class What { add, remove, edit, withdraw };
  const json::Object fields(message, {"id", "do", "what", "path", "sample", "resolution", "upload", "name"});
  const What what = fields.required("what").choice<What>(
      {{"add", What::add}, {"remove", What::remove}, {"edit", What::edit}, {"withdraw", What::withdraw}});
  const EditFile& edit = open_one().document().edit;
  Json document = open_one().document().json;
  if (what == What::remove) {
    const std::string name = fields.required("name").name();
    if (const auto resumed = resumed_graft(open_one().document(), open_one().history());
        resumed && resumed->before.json["inputs"].contains(name)) {
      Json before = resumed->before.json;  // Cancel needs the part that it uses
      remove_part(before, resumed->before.edit, name);
    }
    remove_part(document, edit, name);
    return change("remove_part", document, context);
  }
  if (what == What::withdraw) {
    const std::string name = fields.required("name").name();
    if (part_of_last_change(open_one().history()) != name)
      throw Error(facts::editor::PartNotAdded{.name = name}, "name");
    open_one().withdraw(context);
    return shown();
  }
  if (what == What::edit) {
    require_no_graft(edit, "part");
    edit_part(document, edit, fields.required("name").name());
    return change("edit_part", document, context);
  }
  require_one_of(message, {"path", "sample", "upload"});
  Json input;
  std::string name;
  if (fields.has("sample")) {
    name = fields.required("sample").name();
    input = {{"sample", name}};
    fields.optional("resolution", [&](const json::Value& v) { input["resolution"] = v.integer_in(4, 4096); });
  } else {
    fs::path file = mesh_file(fields);
    const fs::path called = fields.has("upload") ? uploaded_as(file) : file;
    if (fields.has("upload")) file = open_one().kept_upload(file);
    name = called.stem().empty() ? "part" : called.stem().string();
    input = file_input(edit.base_folder, file);
  }
  const bool is_named = fields.has("name");
  if (is_named) name = fields.required("name").name();
  const std::string part = add_part(document, edit, input, name, !is_named);
  Json result = change("add_part", document, context, {{"name", part}});
  result["notes"] = file_notes_json(open_one().notes_on_inputs(part, shared_.upload_folder));
  return result;
}

Json Worker::loops(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do", "mesh"});
  const std::shared_ptr<const Object> object = object_of(fields);
  Json loops = Json::array();
  for (const std::vector<Index>& loop : object->loops)
    loops.push_back(loop_json(object->mesh().positions, loop));
  outbox_.send(loops_frame(*object));
  return {{"loops", loops}};
}

Json Worker::cut(const json::Value& message, const Context& context) {
  const json::Object fields(message,
                            {"id", "do", "mesh", "plane", "loop", "keep", "halves", "snap", "cap", "pins"});
  const EditFile& edit = open_one().document().edit;
  require_no_graft(edit, "cut");
  bool halves = false;
  fields.optional("halves", [&](const json::Value& v) { halves = v.boolean(); });
  if (halves && fields.has("keep"))
    message.fail(facts::script::NotOneOf{.names = std::array{"halves", "keep"}});
  Json step = {{"kind", "cut"}, {"mesh", object_of(fields)->name}};
  for (const char* field : {"plane", "loop", "keep", "snap", "cap", "pins"})
    fields.optional(field, [&](const json::Value& v) { step[field] = v.raw(); });
  require_one_of(message, {"plane", "loop"});
  if (!halves) return cut_once(std::move(step), context);
  try {
    Json document = open_one().document().json;
    const Halves made = add_halves(document, edit, step);
    Json result = change("cut", document, context, {{"name", made.part}});
    result["notes"] = open_one().stage().found.at(made.step)["notes"];
    return result;
  } catch (const Error& error) {
    if (error.id() != "mesh.loop_does_not_part") throw;
    return cut_once(std::move(step), context);  // the curve opens the surface, and divides nothing
  }
}

Json Worker::cut_once(Json step, const Context& context) {
  Json document = open_one().document().json;
  const std::size_t index = add_mesh_step(document, open_one().document().edit, std::move(step));
  Json result = change("cut", document, context);
  result["notes"] = open_one().stage().found.at(index)["notes"];
  return result;
}

// Returns the fields of a merge step that a request has. `fixed` may stand for the selection on the source.
Json Worker::graft_fields_of(const json::Object& fields) {
  Json given = Json::object();
  for (const std::string_view name : merge_fields)
    fields.optional(name, [&](const json::Value& v) { given[std::string(name)] = v.raw(); });
  for (const char* side : {"target", "source"})
    fields.optional(side, [&](const json::Value& v) { open_one().object(v.name()); });
  return given;
}

// Returns the document with a graft that has the given fields.
Json Worker::with_graft(Json given) {
  const EditFile& edit = open_one().document().edit;
  Json document = open_one().document().json;
  const bool means_selection = given.contains("fixed") && given["fixed"] == true;
  if (means_selection) given.erase("fixed");
  set_graft(document, edit, given);
  Json& step = document["steps"].back();
  if (means_selection) step["fixed"] = selected_on(step["source"]);
  return document;
}

// Returns the document after Cancel: with its graft as it was before it was taken up again, or else without the
// graft and the part that was added for it.
Json Worker::without_graft() {
  const Document& current = open_one().document();
  if (const auto resumed = resumed_graft(current, open_one().history()))
    return cancelled_again(current.json, *resumed);
  Json document = current.json;
  cancel_graft(document, current.edit);
  const std::string part = part_of_drop(open_one().history());
  if (part == merge_in_work(current.edit)->source) remove_part(document, current.edit, part);
  return document;
}

Json Worker::graft(const json::Value& message, const Context& context) {
  enum class What { set, cancel, resume, swap };
  const json::Object fields(message, graft_fields_and({"id", "do", "what", "with_part", "step"}));
  What what = What::set;
  fields.optional("what", [&](const json::Value& v) {
    what = v.choice<What>(
        {{"set", What::set}, {"cancel", What::cancel}, {"resume", What::resume}, {"swap", What::swap}});
  });
  const EditFile& edit = open_one().document().edit;
  const Json given = graft_fields_of(fields);
  if ((what != What::set && (!given.empty() || fields.has("with_part"))) ||
      (what != What::resume && fields.has("step")))
    message.fail(facts::editor::FieldsWithoutUse{});
  const bool starts = merge_in_work(edit) == nullptr;
  bool with_part = false;
  fields.optional("with_part", [&](const json::Value& v) { with_part = v.boolean(); });
  const History& history = open_one().history();
  Json document = open_one().document().json;
  if (what == What::set) document = with_graft(given);
  if (what == What::cancel) document = without_graft();
  if (what == What::resume) {
    std::optional<std::size_t> step;
    fields.optional("step", [&](const json::Value& v) { step = static_cast<std::size_t>(v.vertex()); });
    resume_graft(document, edit, step);
  }
  if (what == What::swap) {
    if (const std::size_t count = open_one().steps_set_aside().size(); count > 0)
      throw Error(facts::editor::StepsSetAside{.count = count}, "swap");
    swap_graft(document, edit);
  }
  const bool is_drop =
      starts && with_part && document["steps"].back()["source"] == part_of_last_change(history);
  if (is_drop)
    open_one().extend_change("drop_part", document, context);
  else
    open_one().change(what == What::cancel   ? "cancel_graft"
                      : what == What::resume ? "resume_graft"
                      : starts               ? "start_graft"
                                             : "graft",
                      document, context);
  tell_change();
  return shown_graft();
}

Json Worker::graft_drag(const json::Value& message, const Context& context) {
  const json::Object fields(message, graft_fields_and({"id", "do"}));
  const Json given = graft_fields_of(fields);
  open_one().drag_graft(given.empty() ? open_one().document().json : with_graft(given), context);
  return shown_graft();
}

Json Worker::shown_graft() {
  Json result = {{"graft", open_one().graft_number()}};
  try {
    if (const auto placement = open_one().placement_of_last_drop())
      result["transform"] = matrix_json(*placement);
  } catch (const Error&) {  // the event `graft` reports errors about the location
  }
  return result;
}

Json Worker::thumbnail(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do", "path", "upload", "mesh", "size"});
  require_one_of(message, {"path", "upload", "mesh"});
  Thumbnails::Task task;
  task.request = {message.raw().at("id"), "thumbnail", {}};
  fields.optional("size", [&](const json::Value& v) { task.size = static_cast<int>(v.integer_in(16, 512)); });
  if (fields.has("mesh")) {
    task.mesh = [state = object_of(fields)->shared_state](const Context&) {
      return std::shared_ptr<const Mesh>(state, &state->mesh);
    };
  } else {
    const std::filesystem::path file = mesh_file(fields);
    task.mesh = [file](const Context& context) {
      return std::make_shared<const Mesh>(read_mesh(file, context));
    };
  }
  thumbnails_.push(std::move(task));
  return Json(Json::value_t::discarded);
}

}  // namespace meshgraft::editor
