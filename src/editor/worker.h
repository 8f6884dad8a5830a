#pragma once

#include <filesystem>
#include <functional>
#include <initializer_list>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "deform/measure/print_check.h"
#include "folders.h"
#include "numbers.h"
#include "protocol.h"
#include "request_queue.h"
#include "script/json_value.h"
#include "thumbnails.h"
#include "workspace.h"

namespace meshgraft::editor {

/// State that all sessions share.
struct Shared {
  Folders folders;
  std::vector<std::filesystem::path> models;  ///< offered to the page
  std::filesystem::path upload_folder;        ///< empty: uploads are disabled
  std::filesystem::path result;               ///< the edit file for a program that waits; empty: none waits
  std::function<void()> end;                  ///< ends the editor once its pages have heard the answer
  Numbers numbers{};
};

/// Returns the paths of the folders that a page may use.
Json folders_json(const Shared& shared);

/// Throws Error(input) unless a message has exactly one of these fields.
void require_one_of(const json::Value& message, std::initializer_list<std::string_view> names);

/// Works on one page's requests (protocol.schema.json) on a thread of its own.
class Worker {
 public:
  Worker(std::shared_ptr<Channel> channel, Shared& shared);
  ~Worker();
  Worker(const Worker&) = delete;
  Worker& operator=(const Worker&) = delete;

  /// Queues a message; answers a malformed one at once.
  void receive(std::string_view text);

 private:
  using Answer = Json (Worker::*)(const json::Value&, const Context&);
  static Answer answer_to(const std::string& what);

  void queue(Request request);
  void work(const std::stop_token& stop);
  void perform(const RequestQueue::Work& work);
  Context context_of(const RequestQueue::Work& work) const;
  Workspace& open_one();
  void show(std::unique_ptr<Workspace> workspace);
  void tell_state();
  void tell_change();
  std::filesystem::path output(const json::Object& fields, std::string_view name, bool overwrite);
  std::vector<std::filesystem::path> files_of(const json::Value& parts);
  EditFile form_to_save(const std::filesystem::path& folder);
  void write_result();
  void save_edit(const std::filesystem::path& file, const Context& context);
  Json selection_or(const json::Object& fields, const std::string& on);
  Json selected_on(const std::string& name);
  std::string model_name() { return open_one().stage().model->name; }
  std::shared_ptr<const Object> object_of(const json::Object& fields);
  std::filesystem::path mesh_file(const json::Object& fields);
  Json graft_fields_of(const json::Object& fields);
  Json with_graft(Json given);
  Json without_graft();
  Json shown_graft();  ///< number of the shown graft, and the placement of a dropped source
  Json change(const std::string& label, const Json& document, const Context& context,
              Json result = Json::object());
  std::unique_ptr<Workspace> workspace_of(Document document, Workspace::Source source, bool resume,
                                          const Context& context);
  Json cut_once(Json step, const Context& context);  ///< adds one cut
  Json shown(Json result = Json::object());  ///< adds the number of the pose whose frames show the change

  // One function per request. A discarded result means that another thread sends the answer.
  Json open(const json::Value& message, const Context& context);
  Json list(const json::Value& message, const Context& context);
  Json add_folder(const json::Value& message, const Context& context);
  Json restore(const json::Value& message, const Context& context);
  Json discard(const json::Value& message, const Context& context);
  Json select(const json::Value& message, const Context& context);
  Json group(const json::Value& message, const Context& context);
  Json paint_handle(const json::Value& message, const Context& context);
  Json reach(const json::Value& message, const Context& context);
  Json region(const json::Value& message, const Context& context);
  Json fixed(const json::Value& message, const Context& context);
  Json handle(const json::Value& message, const Context& context);
  Json drag(const json::Value& message, const Context& context);
  Json pose(const json::Value& message, const Context& context);
  Json part(const json::Value& message, const Context& context);
  Json loops(const json::Value& message, const Context& context);
  Json cut(const json::Value& message, const Context& context);
  Json mark(const json::Value& message, const Context& context);
  Json repair(const json::Value& message, const Context& context);
  Json print_check(const json::Value& message, const Context& context);
  Json transform(const json::Value& message, const Context& context);
  Json graft(const json::Value& message, const Context& context);
  Json graft_drag(const json::Value& message, const Context& context);
  Json thumbnail(const json::Value& message, const Context& context);
  Json settings(const json::Value& message, const Context& context);
  Json symmetry(const json::Value& message, const Context& context);
  Json sculpt(const json::Value& message, const Context& context);
  void require_graft_alone(bool changes, std::size_t index);
  Json step(const json::Value& message, const Context& context);
  Json accept(const json::Value& message, const Context& context);
  Json undo(const json::Value& message, const Context& context);
  Json redo(const json::Value& message, const Context& context);
  Json reset(const json::Value& message, const Context& context);
  Json leave_set_up(const json::Value& message, const Context& context);
  Json save(const json::Value& message, const Context& context);
  Json done(const json::Value& message, const Context& context);
  Json export_mesh(const json::Value& message, const Context& context);
  Json state(const json::Value& message, const Context& context);

  Shared& shared_;
  Outbox outbox_;
  RequestQueue queue_;
  std::unique_ptr<Workspace> workspace_;

  /// The mesh that was checked last for printing, and what was found.
  struct CheckedPrint {
    Mesh mesh;
    PrintCheck check;
  };
  std::unique_ptr<CheckedPrint> print_;
  Thumbnails thumbnails_;
  std::jthread thread_;
};

}  // namespace meshgraft::editor
