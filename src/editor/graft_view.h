#pragma once

#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <thread>

#include "numbers.h"
#include "objects.h"
#include "protocol.h"

namespace meshgraft::editor {

/// A graft to be shown: the last step of a document, and the two that it joins.
struct GraftJob {
  Document document;
  std::shared_ptr<const Object> target, source;
  bool dragged = false;  ///< for now, and no part of what the page has open
};

/// Shows what grafts come to while they are set up: each is run, as saving would run it, on a thread of this
/// class, and sent to the page with what is to be told of it. Newer ones supersede those that wait, and stop
/// the one that runs; a drag does not stop a drag, so that some come to be shown. Used on one thread.
class GraftView {
 public:
  GraftView(Outbox outbox, const Numbers& numbers);
  ~GraftView();
  GraftView(const GraftView&) = delete;
  GraftView& operator=(const GraftView&) = delete;

  /// Returns the number under which the page is told.
  std::int64_t show(GraftJob job);

  /// Whether something is run, or waits for it.
  bool is_busy();

  /// Nothing more is sent, from this call on.
  void clear();

  /// What the last job from the document came to, once: without a scene while it runs, and where it failed.
  StepOutcome take_outcome();

 private:
  struct Numbered {
    GraftJob job;
    std::int64_t number = 0;
  };
  void work(const std::stop_token& stop);
  void run(const Numbered& numbered, const std::stop_token& stop);

  Outbox outbox_;
  const Numbers& numbers_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Numbered> waiting_;
  std::optional<bool> running_dragged_;
  std::stop_source running_stop_;
  StepOutcome outcome_;
  std::jthread thread_;
};

}  // namespace meshgraft::editor
