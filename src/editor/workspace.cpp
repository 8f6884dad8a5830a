#include "workspace.h"

#include <utility>

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

Json vector_json(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

// With long lists counted: nobody reads the numbers of a thousand vertices.
Json without_long_lists(const Json& json) {
  constexpr std::size_t longest = 16;
  if (json.is_array() && json.size() > longest) return {{"count", json.size()}};
  if (!json.is_structured()) return json;
  Json shortened = json;
  for (Json& part : shortened) part = without_long_lists(part);
  return shortened;
}

// A step without what every line of a list of steps shows; handles stay a list, however many there are.
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

Json step_summary(const Json& step) {
  Json summary = {{"kind", step["kind"]}};
  if (step.contains("name")) summary["name"] = step["name"];
  summary["handles"] = step.contains("handles") ? step["handles"].size() : 0;
  summary["fields"] = step_details(step);
  return summary;
}

// As the request of this name has it, with the handles' twins.
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

Json handle_summary(const Json& step, const Json& handle, const std::vector<ShownHandle>& shown) {
  Json summary = {{"name", handle["name"]},
                  {"shape", handle.value("shape", "region")},
                  {"pose", handle.value("pose", Json::object())}};
  if (const auto reach = reach_of(step, handle)) summary["reach"] = *reach;
  for (const ShownHandle& one : shown)
    if (one.handle.name == handle["name"])
      summary.update({{"vertices", one.handle.vertices.size()},
                      {"closed", one.handle.closed},
                      {"centre", vector_json(one.centre)},
                      {"pivot", vector_json(one.pivot)},
                      {"rim", one.rim}});
  return summary;
}

}  // namespace

Workspace::Workspace(Document document, Source source, const Folders& folders, Outbox outbox,
                     const Context& context)
    : source_(std::move(source)),
      folders_(folders),
      outbox_(outbox),
      view_(std::move(outbox)),
      history_(document.text),
      saved_(document.text) {
  show(checked(std::move(document)), context);
}

void Workspace::keep_journal() {
  if (!source_.journal.empty()) journal_ = std::make_unique<Journal>(source_.journal);
}

Document Workspace::checked(Document document) const {
  folders_.require_inside(document.edit);
  return document;
}

void Workspace::show(Document next, const Context& context) {
  LiveView::Plan plan = view_.plan(next, bases_.before(next, context));
  try {
    view_.show(next, std::move(plan), context);
  } catch (...) {
    if (!document_.text.empty()) view_.show(document_, view_.plan(document_, bases_.before(document_, {})), {});
    throw;
  }
  document_ = std::move(next);
  std::erase_if(selection, [&](Index v) { return v >= view_.base().mesh().vertex_count(); });
}

// An action goes on where its journal cannot: the page is told, once.
template <class Step>
void Workspace::write(Step&& step) {
  if (!journal_) return;
  try {
    step(*journal_);
  } catch (const std::exception&) {
    outbox_.tell("notice", {{"error", error_json(current_error())}});
    journal_.reset();
  }
}

void Workspace::change(const std::string& label, const Json& changed, const Context& context) {
  Document next = checked(make_document(changed, document_.edit.base_folder));
  if (next.text == document_.text) return;
  show(std::move(next), context);
  write([&](Journal& journal) {
    if (journal.found()) journal.set_aside();  // going on is an answer to the offer
    journal.add(label, history_.current(), document_.text);
  });
  history_.add(label, document_.text);
}

void Workspace::undo(const Context& context) {
  if (!history_.can_undo()) throw Error(ErrorCode::usage, "there is nothing to undo", "undo");
  show(checked(parse_document(history_.before().document, document_.edit.base_folder)), context);
  write([](Journal& journal) { journal.undo(); });
  history_.undo();
}

void Workspace::redo(const Context& context) {
  if (!history_.can_redo()) throw Error(ErrorCode::usage, "there is nothing to redo", "redo");
  show(checked(parse_document(history_.after().document, document_.edit.base_folder)), context);
  write([](Journal& journal) { journal.redo(); });
  history_.redo();
}

void Workspace::reset(const Context& context) { change("reset", Json::parse(history_.first()), context); }

std::optional<Json> Workspace::offer() const {
  if (!journal_ || !journal_->found()) return std::nullopt;
  const JournalContent& found = *journal_->found();
  return Json{{"changes", found.changes}, {"last", found.history.label()}};
}

void Workspace::restore(const Context& context) {
  if (!offer()) throw Error(ErrorCode::usage, "there is nothing to restore", "restore");
  History restored = journal_->found()->history;
  show(checked(parse_document(restored.current(), document_.edit.base_folder)), context);
  history_ = std::move(restored);
  saved_.clear();
  write([](Journal& journal) { journal.take_up(); });
}

fs::path Workspace::decline() {
  if (!offer()) throw Error(ErrorCode::usage, "there is nothing to discard", "discard");
  return journal_->set_aside();
}

void Workspace::finish(const Context& context) {
  const DeformStep* step = deform_in_work(document_.edit);
  if (step == nullptr || !is_ready(*step)) return;
  if (StepBases::Scenes scenes = view_.outcome(document_, context))
    bases_.remember(document_, std::move(scenes));
}

Workspace::Outcome Workspace::outcome(const Context& context) {
  finish(context);
  const EditFile saved = saved_form(document_, document_.edit.base_folder);
  const StepBases::Scenes scenes = bases_.after(document_, saved.steps.size(), context);
  const Scene& scene = scenes->at(saved.output.empty() ? outcome_of(saved.steps.back()) : saved.output);
  return {scene.mesh, scene.rest};
}

void Workspace::mark_saved(const fs::path& edit) {
  source_.edit = edit;
  saved_ = document_.text;
  write([](Journal& journal) { journal.mark_saved(); });
}

Json Workspace::summary() const {
  Json steps = Json::array(), handles = Json::array(), groups = Json::array();
  for (const Json& step : document_.json["steps"]) steps.push_back(step_summary(step));
  Json settings = nullptr, symmetry = nullptr;
  if (deform_in_work(document_.edit) != nullptr) {
    const Json& step = document_.json["steps"].back();
    settings = step["settings"];
    symmetry = symmetry_summary(step, view_);
    for (const Json& handle : step.value("handles", Json::array()))
      handles.push_back(handle_summary(step, handle, view_.handles()));
  }
  for (const NamedSelection& group : document_.edit.selections)
    groups.push_back({{"name", group.name}, {"colour", group.colour}});
  const Mesh& mesh = view_.base().mesh();
  return {{"name", source_.name},
          {"edit", source_.edit.string()},
          {"model",
           {{"mesh", view_.base().id},
            {"vertices", mesh.vertex_count()},
            {"faces", mesh.face_count()},
            {"diagonal", view_.base().diagonal}}},
          {"steps", steps},
          {"handles", handles},
          {"groups", groups},
          {"counts", view_.counts()},
          {"settings", settings},
          {"symmetry", symmetry},
          {"notes", view_.notes()},
          {"selected", selection.size()},
          {"undo", history_.can_undo() ? Json(history_.label()) : Json()},
          {"redo", history_.can_redo() ? Json(history_.after().label) : Json()},
          {"dirty", document_.text != saved_}};
}

}  // namespace meshgraft::editor
