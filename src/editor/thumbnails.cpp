#include "thumbnails.h"

#include <array>
#include <chrono>
#include <cstdint>
#include <utility>

#include <meshgraft/core/error.h>

#include "binary_message.h"
#include "editor/facts.h"
#include "mesh/shown_orientation.h"
#ifdef MESHGRAFT_HAS_RENDER
#include "render/render.h"
#include "render/viewpoint.h"
#endif

namespace meshgraft::editor {

namespace {

constexpr std::size_t most_waiting = 10'000;  // as many as a folder's list has entries
constexpr auto most_time = std::chrono::seconds(20);
constexpr std::uint64_t most_memory = std::uint64_t{2} << 30;  // of a file

/// Requests a stop when another one is requested, or when a time has passed.
class TimeLimit {
 public:
  TimeLimit(const std::stop_token& other, std::chrono::seconds time)
      : forward_(other, Forward{&stop_}), timer_([this, time](const std::stop_token& over) {
          std::unique_lock lock(mutex_);
          changed_.wait_for(lock, over, time, [] { return false; });
          if (!over.stop_requested()) stop_.request_stop();
        }) {}

  std::stop_token token() const { return stop_.get_token(); }

 private:
  struct Forward {
    std::stop_source* stop;
    void operator()() const { stop->request_stop(); }
  };
  std::stop_source stop_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::stop_callback<Forward> forward_;
  std::jthread timer_;
};

#ifdef MESHGRAFT_HAS_RENDER
// Renders a mesh as the page first shows it: from the front, a little from the side and above.
std::vector<std::uint8_t> picture_of(const Mesh& mesh, int size, const Context& context) {
  const std::array shapes{render::Shape{&mesh, render::vertex_colours(mesh)}};
  render::RenderOptions options;
  options.width = options.height = size;
  options.transparent = true;
  const Orientation orientation = shown_orientation(mesh);
  options.camera.up = orientation.up;
  options.camera.from_direction = render::usual_direction(orientation);
  return render::png_bytes(render::render(shapes, options, context));
}

void require_pictures() {}
#else
std::vector<std::uint8_t> picture_of(const Mesh&, int, const Context&) { return {}; }

void require_pictures() { throw Error(facts::editor::NoPictures{}, "thumbnail"); }
#endif

}  // namespace

Thumbnails::Thumbnails(Outbox outbox) : outbox_(std::move(outbox)) {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

Thumbnails::~Thumbnails() {
  cancel(nullptr);
  thread_.request_stop();
}

void Thumbnails::push(Task task) {
  require_pictures();
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= most_waiting) throw Error(facts::editor::TooManyRequests{}, "thumbnail");
  waiting_.push_back(std::move(task));
  changed_.notify_all();
}

std::vector<Request> Thumbnails::cancel(const Json& id) {
  const std::lock_guard lock(mutex_);
  if (id.is_null() || running_id_ == id) running_stop_.request_stop();
  const auto is_meant = [&](const Task& task) { return id.is_null() || task.request.id == id; };
  std::vector<Request> taken;
  for (const Task& task : waiting_)
    if (is_meant(task)) taken.push_back(task.request);
  std::erase_if(waiting_, is_meant);
  return taken;
}

void Thumbnails::work(const std::stop_token& stop) {
  while (true) {
    Task task;
    std::stop_token cancelled;
    {
      std::unique_lock lock(mutex_);
      running_id_ = nullptr;
      if (!changed_.wait(lock, stop, [&] { return !waiting_.empty(); })) return;
      task = std::move(waiting_.front());
      waiting_.pop_front();
      running_id_ = task.request.id;
      running_stop_ = {};
      cancelled = running_stop_.get_token();
    }
    make(task, cancelled);
  }
}

void Thumbnails::make(const Task& task, const std::stop_token& stop) {
  try {
    const TimeLimit limit(stop, most_time);
    Context context;
    context.stop_token = limit.token();
    context.memory = most_memory;
    const std::vector<std::uint8_t> picture = picture_of(*task.mesh(context), task.size, context);
    BinaryMessage message(MessageKind::thumbnail, {{"mesh", 0}, {"of", task.request.id}, {"size", task.size}});
    message.add("png", picture);
    outbox_.send(message.bytes());
    outbox_.reply(task.request.id, {{"bytes", picture.size()}});
  } catch (...) {
    outbox_.refuse(task.request.id, current_error());
  }
}

}  // namespace meshgraft::editor
