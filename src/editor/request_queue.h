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

/// Requests on their way from the page to the thread that works on them. Safe to use from any thread.
class RequestQueue {
 public:
  static constexpr std::size_t limit = 1000;  ///< of waiting requests

  struct Work {
    Request request;
    std::stop_token stop;  ///< of this one
  };

  /// Queues a request. Returns those that it makes needless: drags that a newer one supersedes, and models that
  /// are not yet open when another one is asked for; of the latter the running one is stopped. Throws
  /// Error(usage) if too many wait.
  std::vector<Request> push(Request request);

  /// The next request, after at most `patience` nothing. The one before it is then done.
  std::optional<Work> pop(std::chrono::milliseconds patience);

  /// Stops the running request and takes out those that wait: the one with this id, or all for null. Returns
  /// those that were taken out.
  std::vector<Request> cancel(const Json& id);

  /// Wakes who waits, and stops what runs.
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
