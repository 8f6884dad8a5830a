#include "workspace.h"

#include <algorithm>
#include <exception>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Core>

#include <meshgraft/mesh/orientation.h>

#include "editor/facts.h"
#include "graft_actions.h"
#include "graft_messages.h"
#include "io/file.h"
#include "io/file_document.h"
#include "mesh/shown_orientation.h"
#include "mesh_messages.h"
#include "script/fact_json.h"
#include "script/sha256.h"
#include "script/vector_json.h"
#include "step_actions.h"
#include "twist.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

// Replaces long lists by their counts: nobody reads the numbers of a thousand vertices.
Json without_long_lists(const Json& json) {
  constexpr std::size_t longest = 16;
  if (json.is_array() && json.size() > longest) return {{"count", json.size()}};
  if (!json.is_structured()) return json;
  Json shortened = json;
  for (Json& part : shortened) part = without_long_lists(part);
  return shortened;
}

// Returns a step without the fields that every line of a list of steps shows. Handles stay a list of any
// length.
Json step_details(const Json& step) {
  Json details = Json::object();
  for (const auto& [name, value] : step.items()) {
    if (name == "kind" || name == "name") continue;
    details[name] = value;
    if (name != "handles") details[name] = without_long_lists(value);
    if (name == "handles")
      for (Json& handle : details[name]) handle = without_long_lists(handle);
  }
  return details;
}

Json step_summary(const Json& step, const Json& found) {
  Json summary = {{"kind", step["kind"]}};
  if (step.contains("name")) summary["name"] = step["name"];
  summary["handles"] = step.contains("handles") ? step["handles"].size() : 0;
  summary["fields"] = step_details(step);
  if (!found.is_null()) summary["found"] = found;
  return summary;
}

Json set_aside_summary(const std::vector<Json>& steps) {
  Json summary = Json::array();
  for (const Json& step : steps) summary.push_back(step_summary(step, nullptr));
  return summary;
}

// Returns whether a graft turns its source into a mirror image.
bool mirrors(const MergeStep& merge) {
  const bool by_map = merge.source_transform && merge.source_transform->topLeftCorner<3, 3>().determinant() < 0;
  return merge.mirror.has_value() != by_map;
}

// Returns the symmetry in the form of the request `symmetry`, with the handles' twins.
Json symmetry_summary(const Json& step, const LiveView& view) {
  if (!step.contains("symmetry")) return nullptr;
  const Json& symmetry = step["symmetry"];
  Json twins = Json::array();
  if (view.symmetry()) {
    const std::vector<std::size_t>& twin_of = view.symmetry()->twin_of;
    const std::size_t first = view.handles().size() - twin_of.size();
    for (std::size_t t = 0; t < twin_of.size(); ++t)
      twins.push_back(
          {{"name", view.handles()[first + t].handle.name}, {"of", view.handles()[twin_of[t]].handle.name}});
  }
  return {{"plane", {{"point", symmetry["point"]}, {"normal", symmetry["normal"]}}},
          {"tolerance_rel", symmetry["tolerance_rel"]},
          {"twins", twins}};
}

std::string axis_name(const Eigen::Vector3d& direction) {
  for (const char* name : {"x", "-x", "y", "-y", "z", "-z"})
    if (axis_named(name)->isApprox(direction, 1e-6)) return name;
  return {};
}

Json object_summary(const Object& object) {
  return {{"name", object.name},
          {"mesh", object.id},
          {"vertices", object.mesh().vertex_count()},
          {"faces", object.mesh().face_count()},
          {"loops", object.loops.size()},
          {"diagonal", object.diagonal},
          {"findings", findings_json(object.state())}};
}

// Returns the unit of length that the file behind a mesh names, as 3MF spells it. Returns an empty string
// where it names none, and for a mesh that comes from no file. The file behind a graft is the target's.
std::string length_unit(const Mesh& mesh) {
  const io::FileDocument* document = io::origin_of(mesh);
  if (document == nullptr) return {};
  return document->format() == "glTF" ? "meter" : document->unit();  // the unit of every glTF file
}

Json handle_summary(const Json& step, const Json& handle, const LiveView& view) {
  Json summary = {{"name", handle["name"]},
                  {"shape", handle.value("shape", "region")},
                  {"pose", handle.value("pose", Json::object())}};
  if (const auto reach = reach_of(step, handle)) summary["reach"] = *reach;
  for (std::size_t h = 0; h < view.handles().size(); ++h) {
    const ShownHandle& one = view.handles()[h];
    if (one.handle.name != handle["name"].get_ref<const std::string&>()) continue;
    summary.update({{"vertices", one.handle.vertices.size()},
                    {"closed", one.handle.closed},
                    {"centre", vector_json<Json>(one.centre)},
                    {"pivot", vector_json<Json>(one.pivot)},
                    {"rim", one.rim}});
    if (summary["pose"].contains("def")) summary["matrix"] = matrix_json(view.poses()[h].transform);
  }
  return summary;
}

}  // namespace

Workspace::Workspace(Document document, Source source, const Folders& folders, const Numbers& numbers,
                     Outbox outbox, const Context& context)
    : source_(std::move(source)),
      folders_(folders),
      outbox_(outbox),
      objects_(numbers, running_),
      view_(outbox, folders),
      graft_view_(std::move(outbox), numbers, running_),
      history_(document.text),
      saved_(document.text) {
  show(checked(std::move(document)), context);
  shown_as_ = shown_orientation(stage_.model->mesh());
}

// Deletes the list of running steps while the journal is still held: this is an end in order.
Workspace::~Workspace() { running_.keep_in({}); }

void Workspace::keep_journal() {
  if (source_.journal.empty()) return;
  journal_ = std::make_unique<Journal>(source_.journal);
  ended_in_ = RunningSteps::left_in(journal_->running_file());
  if (const fs::path& aside = journal_->unreadable(); !aside.empty())
    outbox_.tell("notice", {{"error", error_json(Error(facts::editor::JournalUnreadable{}, aside))}});
}

Document Workspace::checked(Document document) const {
  folders_.require_inside(document.edit);
  return document;
}

// Shows a document and returns whether a set-up begins.
bool Workspace::show(Document next, const Context& context) {
  learn_graft();
  StepInputs stage = objects_.before(next, context);
  std::optional<RunningSteps::Mark> mark;
  if (deform_in_work(next.edit) != nullptr) mark = running_.begin(Objects::step_keys(next).back());
  LiveView::Plan plan = view_.plan(next, stage.model);
  bool begins = false;
  try {
    begins = view_.show(next, std::move(plan), context);
  } catch (...) {
    if (!document_.text.empty()) view_.show(document_, view_.plan(document_, stage_.model), {});
    throw;
  }
  set_up_ = std::move(mark);
  end_set_up();
  show_parts(stage);
  stage_ = std::move(stage);
  document_ = std::move(next);
  show_graft(document_, stage_, false);
  carry_selection();
  return begins;
}

// The set-up of the current step runs on another thread.
void Workspace::end_set_up() {
  if (view_.settled()) set_up_.reset();
}

void Workspace::poll() {
  view_.poll();
  end_set_up();
}

// Sends the parts that the page does not have yet.
void Workspace::show_parts(const StepInputs& next) {
  const auto is_known = [&](const std::shared_ptr<const Object>& object) {
    return object == stage_.model ||
           std::find(stage_.parts.begin(), stage_.parts.end(), object) != stage_.parts.end();
  };
  for (const auto& part : next.parts)
    if (!is_known(part)) outbox_.send(mesh_frame(*part, "part", folders_));
}

// Stores the outcome of the document's graft, so that it is not run again.
void Workspace::learn_graft() {
  StepOutcome outcome = graft_view_.take_outcome();
  if (outcome.state) objects_.learn(document_, std::move(outcome));
}

void Workspace::show_graft(const Document& document, const StepInputs& stage, bool dragged) {
  const MergeStep* merge = merge_in_work(document.edit);
  if (merge == nullptr) {
    graft_view_.clear();
    graft_number_ = 0;
    last_graft_ = {};
    return;
  }
  last_graft_ = {document, stage.named(merge->target), stage.named(merge->source), dragged};
  graft_number_ = graft_view_.show(last_graft_);
}

std::int64_t Workspace::drag_graft(const Json& changed, const Context& context) {
  const Document asked = make_document(changed, document_.edit.base_folder);
  for (const fs::path& file : referenced_files(asked.edit))
    folders_.inside(file);  // the inputs were read before
  learn_graft();
  const bool dragged = asked.text != document_.text;
  show_graft(asked, objects_.before(asked, context), dragged);
  return graft_number_;
}

std::optional<Eigen::Affine3d> Workspace::placement_of_last_drop() {
  const auto& [document, target, source, dragged] = last_graft_;
  const MergeStep* merge = merge_in_work(document.edit);
  if (merge == nullptr || !merge->at) return std::nullopt;
  Json step = document.json["steps"].back();
  for (const char* field : {"vertex", "point", "spin_deg"}) step["at"].erase(field);
  for (const char* field : {"size", "normal_angle_deg", "settings", "shape"}) step.erase(field);
  const Json key = {target->id, source->id, step, selections_used(document.json, step)};
  if (!placement_ || placement_key_ != key) {
    const Location location =
        (Location::file(document.edit.location) / "steps")[document.edit.steps.size() - 1];
    placement_.emplace(document.edit, *merge, location, target->state(), source->state());
    placement_key_ = key;
  }
  return placement_->map(*merge);
}

const std::shared_ptr<const Object>& Workspace::object(const std::string& name) const {
  return name.empty() ? stage_.model : stage_.named(name);
}

// Keeps the selection where its object has as many vertices as before; else clears it. A mesh that takes the
// place of another one comes to the page without a selection, so the selection is sent again.
void Workspace::carry_selection() {
  const auto is_same = [&](const std::shared_ptr<const Object>& object) {
    return selection.on && object->name == selection.on->name &&
           object->mesh().vertex_count() == selection.on->mesh().vertex_count();
  };
  const auto part = std::find_if(stage_.parts.begin(), stage_.parts.end(), is_same);
  if (part == stage_.parts.end() && !is_same(stage_.model)) selection.vertices.clear();
  const std::shared_ptr<const Object> before =
      std::exchange(selection.on, part == stage_.parts.end() ? stage_.model : *part);
  if (before != selection.on && !selection.vertices.empty())
    outbox_.send(selection_frame(*selection.on, selection.vertices), "selection");
}

// Writes to the journal. Where that fails, the action continues without a journal and the page is told once.
template <class Step>
void Workspace::write(Step&& step) {
  if (!journal_) return;
  try {
    step(*journal_);
    running_.keep_in(journal_->running_file());
  } catch (const std::exception&) {
    outbox_.tell("notice", {{"error", error_json(current_error())}});
    running_.keep_in({});
    journal_.reset();
  }
}

// Marks the journal as saved where the document equals the saved one: then there is nothing to restore.
void Workspace::note_whether_saved() {
  if (document_.text == saved_)
    write([&](Journal& journal) { journal.mark_saved(source_.edit, source_.edit_sha256); });
}

// Shows a changed document. Returns whether a set-up begins; nothing where the document is the same.
std::optional<bool> Workspace::show_changed(const Json& changed, const Context& context) {
  try {
    Document next = checked(make_document(changed, document_.edit.base_folder));
    if (next.text == document_.text) return std::nullopt;
    return show(std::move(next), context);
  } catch (const Error& error) {
    throw with_handle_name(error, changed);
  }
}

void Workspace::change(const std::string& label, const Json& changed, const Context& context) {
  if (const auto begins = show_changed(changed, context)) record(label, *begins);
}

void Workspace::extend_change(const std::string& label, const Json& changed, const Context& context) {
  const auto begins = show_changed(changed, context);
  if (!begins) return;
  write([](Journal& journal) { journal.undo(); });
  history_.undo();
  record(label, *begins);
}

// Adds the shown document to history and journal.
void Workspace::record(const std::string& label, bool begins) {
  write([&](Journal& journal) {
    if (journal.found()) journal.set_aside();  // a change declines the offer to restore
    journal.add(label, history_.current(), document_.text);
  });
  note_whether_saved();
  if (begins)
    before_set_up_ = history_.position();
  else if (before_set_up_ && *before_set_up_ > history_.position())
    before_set_up_.reset();  // the undone states are dropped
  history_.add(label, document_.text);
}

void Workspace::undo(const Context& context) {
  show_before(context);
  write([](Journal& journal) { journal.undo(); });
  note_whether_saved();
  history_.undo();
}

void Workspace::withdraw(const Context& context) {
  show_before(context);
  write([](Journal& journal) { journal.withdraw(); });
  note_whether_saved();
  history_.undo();
  history_.forget_undone();
}

// Shows the document as it was before the last change.
void Workspace::show_before(const Context& context) {
  if (!history_.can_undo()) throw Error(facts::editor::NothingToUndo{}, "undo");
  if (show(checked(parse_document(history_.before().document, document_.edit.base_folder)), context))
    before_set_up_ = history_.position();
}

void Workspace::redo(const Context& context) {
  if (!history_.can_redo()) throw Error(facts::editor::NothingToRedo{}, "redo");
  if (show(checked(parse_document(history_.after().document, document_.edit.base_folder)), context))
    before_set_up_ = history_.position();
  write([](Journal& journal) { journal.redo(); });
  note_whether_saved();
  history_.redo();
}

void Workspace::reset(const Context& context) { change("reset", Json::parse(history_.first()), context); }

// Returns the history position that `leave_set_up` returns to.
std::optional<std::size_t> Workspace::set_up_origin() const {
  if (merge_in_work(document_.edit) == nullptr) return before_set_up_;
  return history_.can_undo() ? std::optional(history_.position() - 1) : std::nullopt;
}

// Returns the label of the change between that position and the current one; after an undo, the label of the
// undone change.
Json Workspace::set_up_label() const {
  const auto origin = set_up_origin();
  if (!origin || *origin == history_.position()) return nullptr;
  return history_.at(*origin < history_.position() ? *origin + 1 : *origin).label;
}

void Workspace::leave_set_up(const Context& context) {
  const auto origin = set_up_origin();
  const bool goes_on = merge_in_work(document_.edit) != nullptr ? graft_view_.is_busy() : !view_.settled();
  if (!goes_on || !origin || *origin == history_.position()) throw Error(facts::editor::NoSetUp{}, "cancel");
  const bool begins =
      show(checked(parse_document(history_.at(*origin).document, document_.edit.base_folder)), context);
  while (history_.position() > *origin) {
    write([](Journal& journal) { journal.undo(); });
    history_.undo();
  }
  while (history_.position() < *origin) {
    write([](Journal& journal) { journal.redo(); });
    history_.redo();
  }
  note_whether_saved();
  before_set_up_.reset();
  if (begins && history_.can_undo()) before_set_up_ = history_.position() - 1;
}

std::optional<Json> Workspace::offer() const {
  if (!journal_ || !journal_->found()) return std::nullopt;
  const History& history = journal_->found()->history;
  return Json{{"changes", history.position()},
              {"undone", history.size() - 1 - history.position()},
              {"last", history.can_undo() ? Json(history.label()) : Json()}};
}

// Returns the first step of a document that ran when the engine of the earlier session was ended.
std::optional<std::size_t> Workspace::step_that_ended(const Document& document) const {
  const std::vector<std::string> keys = Objects::step_keys(document);
  const auto found = std::ranges::find_first_of(keys, ended_in_);
  if (found == keys.end()) return std::nullopt;
  return static_cast<std::size_t>(found - keys.begin());
}

void Workspace::restore(const Context& context) {
  if (!offer()) throw Error(facts::editor::NothingToRestore{}, "restore");
  JournalContent found = *journal_->found();
  History restored = std::move(found.history);
  Document whole = checked(parse_document(restored.current(), document_.edit.base_folder));
  const std::optional<std::size_t> ended = step_that_ended(whole);
  running_.keep_in(journal_->running_file());
  if (ended) {
    Json shortened = whole.json;
    leave_out_steps(shortened, *ended,
                    *ended == 0 ? model_of(whole.edit) : outcome_of(whole.edit.steps[*ended - 1]));
    show(checked(make_document(shortened, document_.edit.base_folder)), context);
  } else {
    show(std::move(whole), context);
  }
  history_ = std::move(restored);
  before_set_up_.reset();
  if (found.saved_edit) learn_saved(std::move(*found.saved_edit));
  write([](Journal& journal) { journal.take_up(); });
  ended_in_.clear();
  if (!ended || document_.text == history_.current()) return;
  write([&](Journal& journal) { journal.add("remove_step", history_.current(), document_.text); });
  history_.add("remove_step", document_.text);
  outbox_.tell("notice", {{"error", error_json(Error(facts::editor::EndedInStep{.step = *ended + 1}))}});
}

// Takes up what the earlier session had saved. Where the edit file is no longer as it was written then, no
// state of the document is saved.
void Workspace::learn_saved(SavedEdit saved) {
  saved_.clear();
  try {
    const fs::path file = folders_.inside(saved.file);
    if (sha256(read_file(file)) != saved.sha256) return;
    source_.edit = file;
    source_.edit_sha256 = std::move(saved.sha256);
    saved_ = std::move(saved.document);
  } catch (const std::exception&) {  // the file is gone, or outside the folders
  }
}

Match Workspace::twisted_start(std::size_t index, std::size_t pair, double by_deg, const Context& context) {
  const auto& steps = document_.edit.steps;
  const auto* merge = index < steps.size() ? std::get_if<MergeStep>(&steps[index].action) : nullptr;
  const Json found = merge != nullptr && index < stage_.found.size() ? stage_.found[index] : Json();
  if (found.is_null() || merge->at || pair >= found["starts"].size())
    throw Error(facts::editor::NoSuchGraft{.step = index + 1, .pair = pair + 1}, "twist");
  const Json& start = found["starts"][pair];
  const auto source = objects_.after(document_, index, merge->source, context);
  const auto target = objects_.after(document_, index, merge->target, context);
  return editor::twisted_start(source->mesh, target->mesh, {start[0].get<Index>(), start[1].get<Index>()},
                               by_deg, mirrors(*merge));
}

fs::path Workspace::decline() {
  if (!offer()) throw Error(facts::editor::NothingToRestore{}, "discard");
  return journal_->set_aside();
}

void Workspace::finish(const Context& context) {
  const DeformStep* step = deform_in_work(document_.edit);
  if (step == nullptr || !is_ready(*step)) return;
  if (auto state = view_.outcome(document_, context)) objects_.learn(document_, {std::move(state)});
}

Workspace::Outcome Workspace::outcome(const Context& context) {
  finish(context);
  const EditFile saved = saved_form(document_, document_.edit.base_folder);
  const auto* only = std::get_if<DeformStep>(&saved.steps.back().action);
  const bool does_nothing = only != nullptr && !is_ready(*only);  // an edit file has at least one step
  const std::string name = does_nothing           ? mesh_of(saved.steps.back())
                           : saved.output.empty() ? outcome_of(saved.steps.back())
                                                  : saved.output;
  const auto state = objects_.after(document_, saved.steps.size() - (does_nothing ? 1 : 0), name, context);
  return {state->mesh, state->rest};
}

Workspace::Outcome Workspace::outcome_for(const std::string& object, const Context& context) {
  if (object.empty() || object == stage_.model->name) return outcome(context);
  const MeshState& state = stage_.named(object)->state();
  return {state.mesh, state.rest};
}

bool Workspace::is_saved(const fs::path& model) const {
  return source_.journal == model && document_.text == saved_ && !offer();
}

void Workspace::mark_saved(const fs::path& edit, std::string edit_sha256) {
  source_.edit = edit;
  source_.edit_sha256 = std::move(edit_sha256);
  saved_ = document_.text;
  write([&](Journal& journal) { journal.mark_saved(source_.edit, source_.edit_sha256); });
}

fs::path Workspace::kept_upload(const fs::path& upload) {
  if (!journal_ || source_.journal.parent_path() == upload.parent_path()) return upload;
  fs::path kept = upload;
  write([&](Journal& journal) {
    if (journal.found()) journal.set_aside();
    kept = journal.keep(upload);
  });
  return kept;
}

fs::path Workspace::kept_folder() const { return journal_ ? journal_->kept_folder() : fs::path(); }

// Loading found these defects; this only formats them.
std::vector<FileNote> Workspace::notes_on_inputs(const std::string& name, const fs::path& uploads) {
  std::vector<FileNote> notes;
  for (const EditInput& input : document_.edit.inputs) {
    if (input.file.empty() || (!name.empty() && input.name != name)) continue;
    const fs::path file = (document_.edit.base_folder / input.file).lexically_normal();
    const bool is_upload = file.parent_path() == uploads || file.parent_path() == kept_folder();
    const auto state = objects_.after(document_, 0, input.name, {});
    for (FileNote& note : notes_on_file(*state, is_upload ? uploaded_as(file) : file))
      notes.push_back(std::move(note));
  }
  return notes;
}

Document Workspace::whole_document() const {
  const auto resumed = resumed_graft(document_, history_);
  if (!resumed || resumed->set_aside().empty()) return document_;
  return make_document(with_later_steps(document_.json, *resumed), document_.edit.base_folder);
}

std::vector<Json> Workspace::steps_set_aside() const {
  const auto resumed = resumed_graft(document_, history_);
  return resumed ? resumed->set_aside() : std::vector<Json>();
}

// Returns the file of the model that was opened. In an edit file, inputs are in the order of their names.
std::string Workspace::file_of_model() const {
  const std::vector<EditInput>& inputs = document_.edit.inputs;
  const auto opened = std::ranges::find(inputs, fs::path(source_.name).stem().string(), &EditInput::name);
  if (opened != inputs.end()) return opened->file;
  return inputs.empty() ? "" : inputs.front().file;
}

Json Workspace::summary() const {
  Json steps = Json::array(), handles = Json::array(), groups = Json::array(), parts = Json::array();
  Json graft = nullptr;
  for (const Json& step : document_.json["steps"])
    steps.push_back(
        step_summary(step, steps.size() < stage_.found.size() ? stage_.found[steps.size()] : Json()));
  Json settings = nullptr, symmetry = nullptr;
  std::vector<Note> notes = document_.edit.notes;
  for (const Note& note : view_.notes()) notes.push_back(note);
  if (deform_in_work(document_.edit) != nullptr) {
    const Json& step = document_.json["steps"].back();
    settings = step["settings"];
    symmetry = symmetry_summary(step, view_);
    for (const Json& handle : step.value("handles", Json::array()))
      handles.push_back(handle_summary(step, handle, view_));
  }
  for (const NamedSelection& group : document_.edit.selections)
    groups.push_back({{"name", group.name}, {"colour", group.colour}});
  for (const auto& part : stage_.parts) {
    parts.push_back(object_summary(*part));
    parts.back()["grafted"] = is_grafted(document_.edit, part->name);
  }
  if (merge_in_work(document_.edit) != nullptr)
    graft = {{"graft", graft_number_},
             {"step", document_.json["steps"].back()},
             {"set_aside", set_aside_summary(steps_set_aside())}};
  return {{"name", source_.name},
          {"file", file_of_model()},
          {"up", axis_name(shown_as_.up)},
          {"front", axis_name(shown_as_.front)},
          {"unit", length_unit(stage_.model->mesh())},
          {"edit", source_.edit.string()},
          {"model", object_summary(*stage_.model)},
          {"parts", parts},
          {"graft", graft},
          {"steps", steps},
          {"handles", handles},
          {"groups", groups},
          {"counts", view_.counts()},
          {"settings", settings},
          {"symmetry", symmetry},
          {"notes", to_json(notes)},
          {"selected", selection.vertices.size()},
          {"selected_on", selection.on->name},
          {"undo", history_.can_undo() ? Json(history_.label()) : Json()},
          {"redo", history_.can_redo() ? Json(history_.after().label) : Json()},
          {"set_up_for", set_up_label()},
          {"dirty", document_.text != saved_}};
}

}  // namespace meshgraft::editor
