#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "protocol.h"

namespace meshgraft::editor {

/// Renders thumbnails one after another on a thread of its own and answers the requests for them. Safe to use
/// from any thread.
class Thumbnails {
 public:
  explicit Thumbnails(Outbox outbox);
  ~Thumbnails();
  Thumbnails(const Thumbnails&) = delete;
  Thumbnails& operator=(const Thumbnails&) = delete;

  struct Task {
    Request request;
    std::function<std::shared_ptr<const Mesh>(const Context&)> mesh;  ///< may throw Error, like read_mesh
    int size = 128;                                                   ///< pixels
  };
  /// Queues a task. Throws Error(usage) in a build without rendering, and if too many tasks wait.
  void push(Task task);

  /// Stops the running task and removes waiting ones, like `RequestQueue::cancel`.
  std::vector<Request> cancel(const Json& id);

 private:
  void work(const std::stop_token& stop);
  void make(const Task& task, const std::stop_token& stop);

  Outbox outbox_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::deque<Task> waiting_;
  Json running_id_;
  std::stop_source running_stop_;
  std::jthread thread_;
};

}  // namespace meshgraft::editor
