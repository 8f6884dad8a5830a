#include "request_queue.h"

#include <algorithm>
#include <utility>

#include "editor/facts.h"

namespace meshgraft::editor {

template <class Condition>
std::vector<Request> RequestQueue::take_out(Condition&& condition) {
  std::vector<Request> taken;
  for (Request& request : waiting_)
    if (condition(request)) taken.push_back(request);
  std::erase_if(waiting_, condition);
  return taken;
}

std::vector<Request> RequestQueue::push(Request request) {
  const std::lock_guard lock(mutex_);
  std::vector<Request> needless;
  if (request.what == "drag" || request.what == "graft-drag" || request.what == "open") {
    needless = take_out([&](const Request& other) { return other.what == request.what; });
    if (request.what == "open" && running_ && running_->what == "open") stop_.request_stop();
  }
  if (waiting_.size() >= limit) throw Error(facts::editor::TooManyRequests{}, Location::field(request.what));
  waiting_.push_back(std::move(request));
  changed_.notify_all();
  return needless;
}

std::optional<RequestQueue::Work> RequestQueue::pop(std::chrono::milliseconds patience) {
  std::unique_lock lock(mutex_);
  running_.reset();
  changed_.wait_for(lock, patience, [&] { return closed_ || !waiting_.empty(); });
  if (closed_ || waiting_.empty()) return std::nullopt;
  Work work{std::move(waiting_.front()), {}};
  waiting_.pop_front();
  stop_ = {};
  work.stop = stop_.get_token();
  running_ = Request{work.request.id, work.request.what, {}};
  return work;
}

std::vector<Request> RequestQueue::cancel(const Json& id) {
  const std::lock_guard lock(mutex_);
  if (running_ && (id.is_null() || running_->id == id)) stop_.request_stop();
  return take_out([&](const Request& request) { return id.is_null() || request.id == id; });
}

void RequestQueue::close() {
  const std::lock_guard lock(mutex_);
  closed_ = true;
  stop_.request_stop();
  changed_.notify_all();
}

}  // namespace meshgraft::editor
