#include "graft_view.h"

#include <map>
#include <string>
#include <utility>

#include <fmt/format.h>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>

#include "graft_messages.h"
#include "merge/facts.h"

namespace meshgraft::editor {

GraftView::GraftView(Outbox outbox, const Numbers& numbers, RunningSteps& running)
    : outbox_(std::move(outbox)), numbers_(numbers), running_(running) {
  thread_ = std::jthread([this](const std::stop_token& stop) { work(stop); });
}

GraftView::~GraftView() {
  clear();
  thread_.request_stop();
}

std::int64_t GraftView::show(GraftJob job) {
  const std::lock_guard lock(mutex_);
  if (!job.dragged || running_dragged_ == false) running_stop_.request_stop();
  if (!job.dragged) outcome_ = {};
  const std::int64_t number = numbers_.next();
  waiting_ = Numbered{std::move(job), number};
  changed_.notify_all();
  return number;
}

bool GraftView::is_busy() {
  const std::lock_guard lock(mutex_);
  return waiting_.has_value() || running_dragged_.has_value();
}

void GraftView::clear() {
  const std::lock_guard lock(mutex_);
  running_stop_.request_stop();
  waiting_.reset();
  outcome_ = {};
}

StepOutcome GraftView::take_outcome() {
  const std::lock_guard lock(mutex_);
  return std::exchange(outcome_, {});
}

void GraftView::work(const std::stop_token& stop) {
  while (true) {
    Numbered next;
    std::stop_token superseded;
    {
      std::unique_lock lock(mutex_);
      running_dragged_.reset();
      if (!changed_.wait(lock, stop, [&] { return waiting_.has_value(); })) return;
      next = std::move(*waiting_);
      waiting_.reset();
      running_dragged_ = next.job.dragged;
      running_stop_ = {};
      superseded = running_stop_.get_token();
    }
    run(next, superseded);
  }
}

void GraftView::run(const Numbered& numbered, const std::stop_token& stop) {
  const auto& [job, number] = numbered;
  const EditFile& edit = job.document.edit;
  EditStep step = edit.steps.back();
  if (job.dragged) std::get<MergeStep>(step.action).retry = false;  // it takes too long to follow the pointer
  Context context;
  context.stop_token = stop;
  if (!job.dragged)
    context.progress = [outbox = outbox_](const Progress& progress) {
      outbox.tell("progress", progress_fields(nullptr, progress), "graft progress");
    };
  std::optional<RunningSteps::Mark> mark;
  if (!job.dragged) mark = running_.begin(Objects::step_keys(job.document).back());
  std::vector<std::byte> frame;
  StepOutcome outcome;
  Json told = {{"graft", number}, {"dragged", job.dragged}};
  try {
    std::map<std::string, MeshState> states{{job.target->name, job.target->state()},
                                            {job.source->name, job.source->state()}};
    const StepReport report = run_step(
        edit, step, (Location::file(edit.location) / "steps")[edit.steps.size() - 1], states, {}, context);
    outcome = {std::make_shared<const MeshState>(std::move(states.at(outcome_of(step)))),
               found_json(*report.merge)};
    const ShownGraft shown{*job.target, *job.source, outcome.state->mesh, report, number, job.dragged};
    frame = graft_frame(shown);
    told = graft_fields(shown);
  } catch (...) {
    told["error"] = error_json(current_error());
  }
  const std::lock_guard lock(mutex_);
  if (!job.dragged) tell_progress_ended(outbox_, "graft progress");
  if (stop.stop_requested()) return;
  if (!job.dragged) outcome_ = std::move(outcome);
  if (!frame.empty()) outbox_.send(std::move(frame), "graft");
  outbox_.tell("graft", std::move(told), "graft told");
}

}  // namespace meshgraft::editor
