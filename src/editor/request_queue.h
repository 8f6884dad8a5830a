#pragma once

#include <chrono>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

#include "protocol.h"

namespace meshgraft::editor {

/// Queues requests from the page for the thread that works on them. Safe to use from any thread.
class RequestQueue {
 public:
  static constexpr std::size_t limit = 1000;  ///< most waiting requests

  struct Work {
    Request request;
    std::stop_token stop;  ///< requested when this request is cancelled
  };

  /// Queues a request and returns the waiting requests that it makes needless. A drag supersedes waiting
  /// drags. A request to open a model supersedes waiting ones and stops the running one. Throws Error(usage)
  /// if too many requests wait.
  std::vector<Request> push(Request request);

  /// Ends the previous request and returns the next one, or nothing where none comes within `patience`.
  std::optional<Work> pop(std::chrono::milliseconds patience);

  /// Stops the running request and removes waiting ones: those with this id, or all for null. Returns the
  /// removed requests.
  std::vector<Request> cancel(const Json& id);

  /// Wakes the waiting thread and stops the running request.
  void close();

 private:
  template <class Condition>
  std::vector<Request> take_out(Condition&& condition);

  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Request> waiting_;
  std::optional<Request> running_;  ///< without its message
  std::stop_source stop_;
  bool closed_ = false;
};

}  // namespace meshgraft::editor
