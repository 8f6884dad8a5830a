#include "worker.h"

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include <meshgraft/core/version.h>
#include <meshgraft/samples/samples.h>

#include "core/facts.h"
#include "editor/facts.h"
#include "script/facts.h"

namespace meshgraft::editor {

using namespace std::chrono_literals;

namespace {

Json welcome(const Shared& shared) {
  Json models = Json::array(), samples = Json::array();
  for (const auto& model : shared.models) models.push_back(model.string());
  for (const SampleInfo& sample : sample_list())
    samples.push_back({{"name", sample.name},
                       {"description", sample.description},
                       {"resolution", sample.default_resolution}});
  return {{"version", MESHGRAFT_VERSION},
          {"folders", folders_json(shared)},
          {"models", models},
          {"samples", samples},
          {"waited_for", !shared.result.empty()}};
}

}  // namespace

Json folders_json(const Shared& shared) {
  Json folders = Json::array();
  for (const auto& folder : shared.folders.roots())
    if (folder != shared.upload_folder) folders.push_back(folder.string());
  return folders;
}

void require_one_of(const json::Value& message, std::initializer_list<std::string_view> names) {
  const auto is_given = [&](std::string_view name) { return message.raw().contains(name); };
  if (std::count_if(names.begin(), names.end(), is_given) != 1)
    message.fail(facts::script::NotOneOf{.names = names});
}

Worker::Worker(std::shared_ptr<Channel> channel, Shared& shared)
    : shared_(shared), outbox_(std::move(channel)), thumbnails_(outbox_) {
  outbox_.tell("welcome", welcome(shared_));
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

Worker::~Worker() {
  thread_.request_stop();
  queue_.close();
}

void Worker::receive(std::string_view text) {
  Json id;
  try {
    queue(parse_request(text, id));
  } catch (...) {
    outbox_.refuse(id, current_error());
  }
}

void Worker::queue(Request request) {
  const Json id = request.id;
  const auto refuse = [&](const std::vector<Request>& needless) {
    for (const Request& one : needless)
      outbox_.refuse(one.id, Error(facts::core::Cancelled{}, Location::field(one.what)));
  };
  const bool is_of_set_up = request.message.contains("of") && request.message["of"].is_null();
  if (request.what == "cancel" && !is_of_set_up) {
    const json::Value message(request.message, request.what);
    json::Object(message, {"id", "do", "of"});
    refuse(queue_.cancel(request.message.value("of", Json())));
    refuse(thumbnails_.cancel(request.message.value("of", Json())));
    return outbox_.reply(id, Json::object());
  }
  answer_to(request.what);
  for (const Request& one : queue_.push(std::move(request)))
    if (one.what == "drag")
      outbox_.reply(one.id, {{"pose", 0}});
    else if (one.what == "graft-drag")
      outbox_.reply(one.id, {{"graft", 0}});
    else
      refuse({one});
}

Worker::Answer Worker::answer_to(const std::string& what) {
  static const std::map<std::string, Answer> answers = {
      {"open", &Worker::open},
      {"list", &Worker::list},
      {"add-folder", &Worker::add_folder},
      {"restore", &Worker::restore},
      {"discard", &Worker::discard},
      {"select", &Worker::select},
      {"group", &Worker::group},
      {"paint-handle", &Worker::paint_handle},
      {"reach", &Worker::reach},
      {"region", &Worker::region},
      {"fixed", &Worker::fixed},
      {"handle", &Worker::handle},
      {"drag", &Worker::drag},
      {"pose", &Worker::pose},
      {"part", &Worker::part},
      {"loops", &Worker::loops},
      {"cut", &Worker::cut},
      {"mark", &Worker::mark},
      {"repair", &Worker::repair},
      {"print-check", &Worker::print_check},
      {"transform", &Worker::transform},
      {"graft", &Worker::graft},
      {"graft-drag", &Worker::graft_drag},
      {"thumbnail", &Worker::thumbnail},
      {"settings", &Worker::settings},
      {"symmetry", &Worker::symmetry},
      {"sculpt", &Worker::sculpt},
      {"step", &Worker::step},
      {"accept", &Worker::accept},
      {"undo", &Worker::undo},
      {"redo", &Worker::redo},
      {"reset", &Worker::reset},
      {"cancel", &Worker::leave_set_up},
      {"save", &Worker::save},
      {"export", &Worker::export_mesh},
      {"done", &Worker::done},
      {"state", &Worker::state},
  };
  const auto answer = answers.find(what);
  if (answer == answers.end()) throw Error(facts::editor::NoSuchRequest{.name = what}, "message.do");
  return answer->second;
}

void Worker::work(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const bool waits_for_frames = workspace_ && !workspace_->view().settled();
    if (const auto work = queue_.pop(waits_for_frames ? 50ms : 1h)) perform(*work);
    if (workspace_) workspace_->poll();
  }
  workspace_.reset();
}

void Worker::perform(const RequestQueue::Work& work) {
  const Request& request = work.request;
  try {
    const json::Value message(request.message, request.what);
    Json result = (this->*answer_to(request.what))(message, context_of(work));
    if (!result.is_discarded()) outbox_.reply(request.id, std::move(result));
  } catch (...) {
    outbox_.refuse(request.id, current_error());
  }
}

Context Worker::context_of(const RequestQueue::Work& work) const {
  Context context;
  context.stop_token = work.stop;
  context.progress = [outbox = outbox_, id = work.request.id](const Progress& progress) {
    outbox.tell("progress", progress_fields(id, progress), "progress");
  };
  return context;
}

Workspace& Worker::open_one() {
  if (!workspace_) throw Error(facts::editor::NothingOpen{});
  return *workspace_;
}

void Worker::tell_state() { outbox_.tell("state", open_one().summary(), "state"); }

void Worker::tell_change() {
  write_result();
  tell_state();
}

Json Worker::change(const std::string& label, const Json& document, const Context& context, Json result) {
  open_one().change(label, document, context);
  return shown(std::move(result));
}

Json Worker::shown(Json result) {
  tell_change();
  result["pose"] = open_one().view().last_pose();
  return result;
}

}  // namespace meshgraft::editor
