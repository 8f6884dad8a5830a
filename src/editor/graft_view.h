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

/// A graft to be shown: the last step of a document and the two meshes that it joins.
struct GraftJob {
  Document document;
  std::shared_ptr<const Object> target, source;
  bool dragged = false;  ///< temporary, not part of the open document
};

/// Previews grafts while they are set up. Each graft is run as saving would run it, on a thread of this
/// class, and sent to the page with its report. A newer job replaces the one that waits and stops the one
/// that runs. A drag does not stop a running drag, so that some previews appear. Call it from one thread
/// only.
class GraftView {
 public:
  /// Marks the graft of a document in `running` while it runs.
  GraftView(Outbox outbox, const Numbers& numbers, RunningSteps& running);
  ~GraftView();
  GraftView(const GraftView&) = delete;
  GraftView& operator=(const GraftView&) = delete;

  /// Queues a job and returns its number, which the page's messages carry.
  std::int64_t show(GraftJob job);

  /// Returns whether a job runs or waits.
  bool is_busy();

  /// Drops all jobs. Nothing more is sent from this call on.
  void clear();

  /// Returns the outcome of the last job from the document and forgets it. The state is null while the job
  /// runs, and where it failed.
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
  RunningSteps& running_;
  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::optional<Numbered> waiting_;
  std::optional<bool> running_dragged_;
  std::stop_source running_stop_;
  StepOutcome outcome_;
  std::jthread thread_;
};

}  // namespace meshgraft::editor
