// Requests that concern files.
#include <algorithm>
#include <deque>
#include <fstream>
#include <memory>
#include <system_error>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>
#include <meshgraft/script/run_edit.h>

#include "document_actions.h"
#include "editor/facts.h"
#include "graft_actions.h"
#include "io/facts.h"
#include "io/file.h"
#include "journal.h"
#include "script/fact_json.h"
#include "script/sha256.h"
#include "worker.h"

namespace meshgraft::editor {

namespace fs = std::filesystem;

namespace {

constexpr std::size_t most_entries = 10'000;  // of a folder's list

bool is_mesh(const fs::path& path) {
  try {
    require_mesh_format(path);
    return true;
  } catch (const Error&) {
    return false;
  }
}

// Returns whether the page may list a file: hidden files, journals and the files kept with journals are not
// listed.
bool is_listed(const std::string& name) {
  return !name.starts_with(".") && name.find(".meshgraft-session") == std::string::npos;
}

bool is_edit(const fs::path& path) {
  if (path.extension() != ".json") return false;
  std::string start(1024, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(start.data(), static_cast<std::streamsize>(start.size()));
  return start.find("meshgraft-edit") != std::string::npos;
}

Document opened_document(const std::string& text, const fs::path& file) {
  try {
    return parse_document(text, file.parent_path());
  } catch (const Error& error) {
    throw in_file(error, file);
  }
}

Document model_document(const fs::path& file, const fs::path& called) {
  const std::string name = called.stem().empty() ? "model" : called.stem().string();
  return make_document(
      new_edit(name, {{"file", file.filename().string()}, {"sha256", sha256(read_file(file))}}),
      file.parent_path());
}

// Adds models as parts that are named after their files.
Document with_parts(Document document, const std::vector<fs::path>& files) {
  for (const fs::path& file : files) {
    const std::string name = file.stem().empty() ? "part" : file.stem().string();
    Json json = document.json;
    add_part(json, document.edit, file_input(document.edit.base_folder, file), name, true);
    document = make_document(json, document.edit.base_folder);
  }
  return document;
}

Document sample_document(const std::string& name, int resolution, const fs::path& folder) {
  Json input = {{"sample", name}};
  if (resolution != 0) input["resolution"] = resolution;
  return make_document(new_edit(name, input), folder);
}

// Returns the document with a step after its last graft, which is then accepted.
Document with_accepted_graft(const Document& document) {
  Json json = document.json;
  accept_step(json, document.edit);
  return make_document(json, document.edit.base_folder);
}

void require_no_input(const fs::path& file, const Document& document) {
  for (const fs::path& input : referenced_files(document.edit))
    for (const fs::path& behind : files_behind(input))
      if (fs::weakly_canonical(behind) == file) throw Error(facts::editor::InputOfEdit{}, file);
}

// Throws io.file_exists or editor.file_changed unless the existing file is the edit's own and unchanged since
// it was last read or written. The page then asks whether to replace it.
void require_own(const fs::path& file, const Workspace::Source& source) {
  if (file != source.edit) throw Error(facts::io::FileExists{.file = file}, file);
  if (sha256(read_file(file)) != source.edit_sha256)
    throw Error(facts::editor::FileChanged{.file = file}, file);
}

// Copies uploads into the folder of the edit, because they last no longer than the program or the journal.
Document with_kept_uploads(const Document& document, const std::vector<fs::path>& uploads,
                           const fs::path& folder) {
  Json json = document.json;
  for (const EditInput& input : document.edit.inputs) {
    const fs::path file = document.edit.base_folder / input.file;
    const fs::path here = file.parent_path();
    const bool is_upload = !here.empty() && std::find(uploads.begin(), uploads.end(), here) != uploads.end();
    if (input.file.empty() || !is_upload || here == folder) continue;
    json["inputs"][input.name]["file"] =
        fs::relative(copy_into(folder, file), document.edit.base_folder).string();
  }
  return make_document(json, document.edit.base_folder);
}

Json written_json(const WriteResult& written) {
  Json files = Json::array();
  for (const fs::path& file : written.files) files.push_back(file.string());
  return {{"files", files}, {"notes", to_json(written.notes)}};
}

// Notes input files that have changed since they were opened, because saved edits will not run on them.
void note_changed_inputs(const Document& document, Json& result) {
  for (const EditInput& input : document.edit.inputs) {
    if (input.file.empty() || !input.sha256) continue;
    const fs::path file = document.edit.base_folder / input.file;
    std::error_code gone;
    if (!fs::exists(file, gone))
      result["notes"].emplace_back(to_json(facts::editor::InputGone{.file = file}));
    else if (sha256(read_file(file)) != *input.sha256)
      result["notes"].emplace_back(to_json(facts::editor::InputReplaced{.file = file}));
  }
}

struct MeshToWrite {
  fs::path file;
  std::string object{};  ///< name of a part; empty: the model
  std::optional<std::string> morph_target{};
};

Json write_outcome(Workspace& workspace, const MeshToWrite& what, const Context& context) {
  const EditFile edit = saved_form(workspace.document(), workspace.document().edit.base_folder);
  const bool same_faces = std::all_of(edit.steps.begin(), edit.steps.end(), [](const EditStep& step) {
    return std::holds_alternative<DeformStep>(step.action) || std::holds_alternative<SculptStep>(step.action);
  });
  if (what.morph_target && !same_faces) throw Error(facts::editor::FacesChange{}, "export.as");
  const Workspace::Outcome result = workspace.outcome_for(what.object, context);
  WriteOptions options;
  if (what.morph_target) options.morph_target = MorphTarget{*what.morph_target, result.rest};
  return written_json(write_mesh(result.mesh, what.file, options, context));
}

// The contents of a folder by their paths from it. `whole` is false where there are too many.
struct Contents {
  std::vector<fs::path> folders, files;
  bool whole = true;
};

// Reads a folder and, if `deep`, all folders within: the nearest first, then by name. Folders within that
// cannot be read count as empty, and so do symbolic links to folders, which may lead round in circles. Throws
// fs::filesystem_error if the folder itself cannot be read.
Contents contents_of(const fs::path& folder, bool deep, const Context& context) {
  Contents contents;
  std::size_t room = most_entries;
  std::deque<fs::path> unread = {fs::path()};
  for (; !unread.empty() && contents.whole; unread.pop_front()) {
    context.throw_if_stopped();
    const fs::path within = unread.front();
    std::error_code unreadable;
    fs::directory_iterator next(folder / within, unreadable);
    if (unreadable && within.empty()) throw fs::filesystem_error("list", folder, unreadable);
    std::vector<fs::directory_entry> entries;
    for (; !unreadable && next != fs::directory_iterator(); next.increment(unreadable))
      if (is_listed(next->path().filename().string())) entries.push_back(*next);
    std::sort(entries.begin(), entries.end());
    contents.whole = entries.size() <= room;
    entries.resize(std::min(entries.size(), room));
    room -= entries.size();
    for (const fs::directory_entry& entry : entries) {
      const fs::path path = within / entry.path().filename();
      std::error_code ignored;
      if (entry.is_directory(ignored)) {
        if (within.empty()) contents.folders.push_back(path);
        if (deep && !entry.is_symlink(ignored)) unread.push_back(path);
      } else if (entry.is_regular_file(ignored) && (is_mesh(entry.path()) || is_edit(entry.path()))) {
        contents.files.push_back(path);
      }
    }
  }
  return contents;
}

}  // namespace

void Worker::show(std::unique_ptr<Workspace> workspace) {
  print_.reset();
  workspace_ = std::move(workspace);  // the previous workspace releases its journal
  workspace_->keep_journal();
  tell_state();
  if (const auto offer = workspace_->offer()) outbox_.tell("offer-restore", *offer);
}

// Opens a document. A graft at its end is accepted, unless it is to be resumed or cannot be run.
std::unique_ptr<Workspace> Worker::workspace_of(Document document, Workspace::Source source, bool resume,
                                                const Context& context) {
  const auto open = [&](Document shown) {
    return std::make_unique<Workspace>(std::move(shown), source, shared_.folders, shared_.numbers, outbox_,
                                       context);
  };
  if (merge_in_work(document.edit) == nullptr || resume) return open(std::move(document));
  try {
    return open(with_accepted_graft(document));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    return open(std::move(document));
  }
}

// Returns the model files that the field `parts` names.
std::vector<fs::path> Worker::files_of(const json::Value& parts) {
  std::vector<fs::path> files;
  for (std::size_t i = 0; i < parts.size(); ++i) files.push_back(shared_.folders.mesh_to_read(parts[i].name()));
  return files;
}

Json Worker::open(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "path", "sample", "resolution", "upload", "resume", "parts"});
  require_one_of(message, {"path", "sample", "upload"});
  Document document;
  Workspace::Source source;
  if (fields.has("sample")) {
    const std::string name = fields.required("sample").name();
    int resolution = 0;
    fields.optional("resolution",
                    [&](const json::Value& v) { resolution = static_cast<int>(v.integer_in(4, 4096)); });
    const bool has_folder =
        !shared_.folders.roots().empty() && shared_.folders.roots().front() != shared_.upload_folder;
    const fs::path folder = has_folder ? shared_.folders.roots().front() : fs::path();
    source.name = name;
    if (has_folder) source.journal = folder / fmt::format("sample-{}-{}", name, resolution);
    document = sample_document(name, resolution, folder);
  } else {
    const bool is_upload = fields.has("upload");
    const fs::path asked = is_upload
                               ? shared_.upload_folder / fs::path(fields.required("upload").name()).filename()
                               : fs::path(fields.required("path").name());
    const fs::path file = shared_.folders.inside(asked);
    const bool edit = !is_upload && file.extension() == ".json";
    const fs::path called = is_upload ? uploaded_as(file) : file;
    source = {called.filename().string(), file};
    if (edit) {
      const std::string text = read_file(file);
      source.edit = file;
      source.edit_sha256 = sha256(text);
      document = opened_document(text, file);
    } else {
      document = model_document(shared_.folders.mesh_to_read(file), called);
    }
  }
  if (fields.has("parts")) {
    if (!source.edit.empty()) fields.required("parts").fail(facts::editor::EditFileHasParts{});
    document = with_parts(std::move(document), files_of(fields.required("parts")));
  }
  bool resume = false;
  fields.optional("resume", [&](const json::Value& v) { resume = v.boolean(); });
  show(workspace_of(std::move(document), std::move(source), resume, context));
  std::vector<FileNote> notes = workspace_->notes_on_inputs({}, shared_.upload_folder);
  for (const Note& note : workspace_->document().edit.notes) notes.push_back({note, {}});
  return {{"name", workspace_->source().name}, {"notes", file_notes_json(notes)}};
}

Json Worker::list(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "folder", "deep"});
  if (!fields.has("folder"))
    return {{"folder", nullptr}, {"folders", folders_json(shared_)}, {"files", Json::array()}, {"whole", true}};
  const fs::path folder = shared_.folders.inside(fields.required("folder").name());
  bool deep = false;
  fields.optional("deep", [&](const json::Value& v) { deep = v.boolean(); });
  const auto [folders, files, whole] = contents_of(folder, deep, context);
  Json folder_names = Json::array(), listed = Json::array();
  for (const fs::path& one : folders) folder_names.push_back(one.string());
  for (const fs::path& one : files) {
    std::error_code ignored;
    const fs::path path = folder / one;
    listed.push_back(
        {{"name", one.generic_string()},
         {"kind", is_mesh(path) ? "model" : "edit"},
         {"bytes", fs::file_size(path, ignored)},
         {"unsaved", !(workspace_ && workspace_->is_saved(path)) && fs::exists(journal_of(path), ignored)}});
  }
  return {{"folder", folder.string()}, {"folders", folder_names}, {"files", listed}, {"whole", whole}};
}

Json Worker::add_folder(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do", "path"});
  const fs::path folder = shared_.folders.add(fields.required("path").name());
  return {{"folder", folder.string()}, {"folders", folders_json(shared_)}};
}

Json Worker::restore(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do"});
  open_one().restore(context);
  return shown();
}

Json Worker::discard(const json::Value& message, const Context&) {
  const json::Object fields(message, {"id", "do"});
  return {{"aside", open_one().decline().string()}};
}

// Returns the file of the field `name`, which may be written; empty where the field is missing.
std::filesystem::path Worker::output(const json::Object& fields, std::string_view name, bool overwrite) {
  if (!fields.has(name)) return {};
  const std::string asked = fields.required(name).name();
  const fs::path file = name == "edit" ? shared_.folders.inside(asked) : shared_.folders.mesh_to_write(asked);
  if (name == "edit" && file.extension() != ".json")
    fields.required(name).fail(facts::editor::EditNameNotJson{});
  if (!shared_.upload_folder.empty() && file.parent_path() == shared_.upload_folder)
    throw Error(facts::editor::NoFolder{}, Location::file(asked));
  if (fs::exists(file) && !overwrite) require_own(file, open_one().source());
  require_no_input(file, open_one().document());
  return file;
}

// Returns the edit for a file in `folder`, with copies of the uploads there.
EditFile Worker::form_to_save(const fs::path& folder) {
  EditFile edit = saved_form(
      with_kept_uploads(open_one().whole_document(), {shared_.upload_folder, open_one().kept_folder()}, folder),
      folder);
  edit.made_with = this_library();
  return edit;
}

// Writes the edit for the program that waits for it, if there is one.
void Worker::write_result() {
  if (shared_.result.empty()) return;
  write_file_atomically(shared_.result, write_edit(form_to_save(shared_.result.parent_path())), {});
}

void Worker::save_edit(const fs::path& file, const Context& context) {
  const std::string text = write_edit(form_to_save(file.parent_path()));
  write_file_atomically(file, text, context);
  open_one().mark_saved(file, sha256(text));
  tell_state();
}

Json Worker::save(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "edit", "mesh", "overwrite"});
  bool overwrite = false;
  fields.optional("overwrite", [&](const json::Value& v) { overwrite = v.boolean(); });
  const fs::path mesh = output(fields, "mesh", overwrite);
  fs::path edit = output(fields, "edit", overwrite);
  if (edit.empty() && mesh.empty()) {
    edit = open_one().source().edit;
    if (!edit.empty() && fs::exists(edit) && !overwrite) require_own(edit, open_one().source());
  }
  if (edit.empty() && mesh.empty()) message.fail(facts::editor::EditWithoutFile{});

  Json result = {{"files", Json::array()}, {"notes", Json::array()}};
  if (!mesh.empty()) result = write_outcome(open_one(), {mesh}, context);
  if (!edit.empty()) {
    save_edit(edit, context);
    result["files"].push_back(edit.string());
  }
  note_changed_inputs(open_one().document(), result);
  return result;
}

// Ends the work for the program that waits. Throws what running the edit throws, so that the page can tell.
Json Worker::done(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do"});
  if (shared_.result.empty()) throw Error(facts::editor::NobodyWaits{});
  open_one().outcome(context);
  write_result();
  shared_.end();
  return Json::object();
}

Json Worker::export_mesh(const json::Value& message, const Context& context) {
  const json::Object fields(message, {"id", "do", "path", "mesh", "as", "name", "overwrite"});
  bool is_morph_target = false, overwrite = false;
  fields.optional("as", [&](const json::Value& v) {
    is_morph_target = v.choice<bool>({{"mesh", false}, {"morph-target", true}});
  });
  fields.optional("overwrite", [&](const json::Value& v) { overwrite = v.boolean(); });
  fields.required("path");
  MeshToWrite what{output(fields, "path", overwrite)};
  if (fields.has("mesh")) what.object = object_of(fields)->name;
  if (is_morph_target) {
    what.morph_target = fields.has("name") ? fields.required("name").name() : "edit";
    require_morph_targets(what.file);
  }
  Json result = write_outcome(open_one(), what, context);
  note_changed_inputs(open_one().document(), result);
  return result;
}

}  // namespace meshgraft::editor
