#include <meshgraft/deform/live_deformer.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <new>
#include <optional>
#include <stop_token>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/deform/quick_frames.h>

#include "core/facts.h"
#include "core/memory.h"
#include "core/parallel.h"
#include "core/require_between.h"
#include "core/reserved_core.h"
#include "core/stopwatch.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/setup/memory_estimate.h"
#include "deform/setup/region_mask.h"
#include "deform/solve/pose_matrix.h"

namespace meshgraft {

namespace {

using Clock = std::chrono::steady_clock;

/// Slower quick frames are not smooth at 60 pictures a second.
constexpr double slow_frame_seconds = 1.0 / 60;
/// Number of slow frames in a row that an accident, such as a busy machine, does not explain.
constexpr int many_slow_frames = 3;

/// A pool of position arrays. An array returns to the pool when the last owner of its frame releases it.
/// Touching as much fresh memory takes as long as computing a linear frame.
class PositionPool : public std::enable_shared_from_this<PositionPool> {
 public:
  explicit PositionPool(Eigen::Index rows) : rows_(rows) { spares_.reserve(most_spares); }

  std::shared_ptr<Points> take() {
    std::unique_ptr<Points> positions = spare();
    if (!positions) positions = std::make_unique<Points>(rows_, 3);
    return {positions.release(),
            [pool = shared_from_this()](Points* back) { pool->give_back(std::unique_ptr<Points>(back)); }};
  }

 private:
  static constexpr std::size_t most_spares = 3;

  std::unique_ptr<Points> spare() {
    const std::lock_guard lock(mutex_);
    if (spares_.empty()) return nullptr;
    std::unique_ptr<Points> positions = std::move(spares_.back());
    spares_.pop_back();
    return positions;
  }
  void give_back(std::unique_ptr<Points> positions) {
    const std::lock_guard lock(mutex_);
    if (spares_.size() < most_spares) spares_.push_back(std::move(positions));
  }

  Eigen::Index rows_;
  std::mutex mutex_;
  std::vector<std::unique_ptr<Points>> spares_;
};

void validate(std::span<const HandlePose> poses, std::span<const Handle> handles) {
  if (poses.size() != handles.size())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::poses, .given = poses.size(), .needed = handles.size()});
  for (std::size_t h = 0; h < poses.size(); ++h) validate(poses[h], Location::handle(handles[h].name));
}

void validate(const LiveOptions& options) {
  validate(options.deformer);
  validate(options.deformer.operators);
  validate(options.reduced);
  if (options.proxy_vertices < 1)
    throw Error(facts::deform::ProxyWithoutVertices{.vertices = options.proxy_vertices}, "proxy_vertices");
  require_between(options.settle_seconds, 0, 3600, "settle_seconds");
}

/// Returns the largest distance between two frames relative to the largest displacement of the exact one.
/// Returns nullopt if nothing moves.
std::optional<double> relative_error(const Points& positions, const Points& exact, const Points& rest) {
  if (rest.rows() == 0) return std::nullopt;
  const double moved = (exact - rest).rowwise().squaredNorm().maxCoeff();
  if (!(moved > 0)) return std::nullopt;
  return std::sqrt((positions - exact).rowwise().squaredNorm().maxCoeff() / moved);
}

}  // namespace

std::string_view to_string(FrameAccuracy value) {
  switch (value) {
    case FrameAccuracy::proxy: return "proxy";
    case FrameAccuracy::reduced: return "reduced";
    case FrameAccuracy::linear: return "linear";
    case FrameAccuracy::exact: return "exact";
  }
  return "";
}

std::string_view to_string(LiveStage value) {
  switch (value) {
    case LiveStage::starting: return "starting";
    case LiveStage::preview: return "preview";
    case LiveStage::exact: return "exact";
    case LiveStage::ready: return "ready";
    case LiveStage::proxy_only: return "proxy-only";
    case LiveStage::failed: return "failed";
    case LiveStage::closed: return "closed";
  }
  return "";
}

namespace {

/// Returns the options without `earlier`, which is released sooner than the others.
LiveOptions without_earlier(LiveOptions options) {
  options.earlier.reset();
  return options;
}

}  // namespace

struct LiveDeformer::Impl {
  Impl(DeformProblem what, LiveCallbacks callbacks, const LiveOptions& options, const Context& context);
  ~Impl();
  void start();
  void close();

  // A method to compute the positions of a pose.
  struct Answer {
    FrameAccuracy accuracy = FrameAccuracy::exact;
    std::function<void(std::span<const HandlePose>, Points&, const Context&)> evaluate;
  };
  struct Job {
    std::int64_t pose = 0;
    std::vector<HandlePose> poses;
    Answer answer;
    Context context;
  };

  // The set-up runs on its own thread.
  void build();
  Context behind(std::string_view task = {});
  void let_exact_pass();
  void make_proxy();
  void make_deformer();
  void make_quick_frames();
  void enter(LiveStage next);
  void give_up(const Error& error);

  // Frames are computed on their own thread.
  void show();
  std::optional<Job> next_job();
  std::optional<Answer> quickest() const;
  Job take(Answer answer);
  void run(const Job& job);
  void deliver(const Job& job, const LiveFrame& frame);
  void refuse(const Job& job, const Error& error);

  const DeformProblem problem;
  const LiveCallbacks callbacks;
  const LiveOptions options;
  const Context context;
  const bool has_curve;
  std::shared_ptr<const Deformer> earlier;  ///< used only by the set-up's thread
  SolvePath path = SolvePath::direct;
  bool wants_proxy = false;
  const std::shared_ptr<PositionPool> pool;
  std::stop_source stop;

  mutable std::mutex mutex;
  mutable std::condition_variable changed;
  // The mutex guards all members from here on.
  LiveStage stage = LiveStage::starting;
  bool closed = false;
  std::shared_ptr<const ProxyDeformer> proxy;
  std::shared_ptr<const Deformer> deformer;
  std::shared_ptr<const HandleBasis> basis;
  std::shared_ptr<const ReducedFrames> reduced;
  std::optional<Error> failure;  ///< error of the exact set-up
  bool failure_told = false;
  std::thread::id setup_thread, frames_thread;
  // State of the newest pose.
  std::int64_t newest = 0;
  std::vector<HandlePose> poses;
  Clock::time_point settled_at;
  std::optional<FrameAccuracy> tried;  ///< greatest accuracy tried so far
  bool shown = false;                  ///< a frame was delivered
  bool refined = false;                ///< an exact frame was delivered
  std::optional<Error> refused;        ///< error of a refused pose
  bool exact_runs = false;
  std::stop_source refinement;  ///< stops an exact evaluation that a newer pose supersedes
  std::int64_t superseded = 0;

  // Used only by the frames' thread.
  LiveFrame last_quick;
  std::array<std::optional<double>, 3> measured;  ///< relative errors of the accuracies below `exact`
  int slow_frames = 0;                            ///< number of slow quick frames in a row
  std::optional<ReservedCore> reserved;           ///< for slow quick frames during the set-up

  std::thread builder, painter;
  std::optional<std::stop_callback<std::function<void()>>> outer_stop;
};

LiveDeformer::Impl::Impl(DeformProblem what, LiveCallbacks calls, const LiveOptions& chosen, const Context& how)
    : problem(std::move(what)),
      callbacks(std::move(calls)),
      options(without_earlier(chosen)),
      context(how),
      has_curve(std::any_of(problem.region.handles.begin(), problem.region.handles.end(),
                            [](const Handle& handle) { return handle.shape == HandleShape::curve; })),
      earlier(chosen.earlier),
      pool(std::make_shared<PositionPool>(problem.rest.rows())) {
  const auto n = static_cast<Index>(problem.rest.rows());
  if (!callbacks.frame) throw Error(facts::deform::NoFrameCallback{});
  if (options.normals.rows() != 0 && options.normals.rows() != n)
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::normals, .given = options.normals.rows(), .needed = n});
  ConstraintList constrained;
  if (!problem.constraints.empty()) throw Error(facts::deform::NoHandles{});
  require_triangles(problem.rest, problem.triangles);
  const ConstraintMask mask = make_mask(n, problem.region, {}, constrained);
  validate(options);
  const auto free = static_cast<Index>(std::count(mask.position.begin(), mask.position.end(), 0));
  path = choose_path(free, options.deformer, available_memory());
  if (path != SolvePath::direct && earlier) {  // the earlier deformer may occupy the memory
    earlier.reset();
    path = choose_path(free, options.deformer, available_memory());
  }
  wants_proxy = path == SolvePath::proxy || free >= options.proxy_from;
}

void LiveDeformer::Impl::start() {
  builder = std::thread([this] { build(); });
  painter = std::thread([this] { show(); });
  outer_stop.emplace(context.stop_token, [this] { close(); });
}

LiveDeformer::Impl::~Impl() {
  outer_stop.reset();
  close();
  if (painter.joinable()) painter.join();
  if (builder.joinable()) builder.join();
}

void LiveDeformer::Impl::close() {
  const std::lock_guard lock(mutex);
  closed = true;
  stage = LiveStage::closed;
  stop.request_stop();
  refinement.request_stop();
  changed.notify_all();
}

/// Builds the solvers one after another. Each is used as soon as it is ready.
void LiveDeformer::Impl::build() {
  {
    const std::lock_guard lock(mutex);
    setup_thread = std::this_thread::get_id();
  }
  try {
    if (wants_proxy) make_proxy();
    make_deformer();
    make_quick_frames();
  } catch (...) {
    give_up(current_error());
  }
}

/// Returns the context for work on the set-up's thread. Its progress names the task.
Context LiveDeformer::Impl::behind(std::string_view task) {
  const auto report = [this, task](Progress progress) {
    let_exact_pass();
    progress.within = task;
    if (context.progress) context.progress(progress);
  };
  return {context.threads, report, stop.get_token()};
}

/// Waits for an exact evaluation, which takes half the time with all cores to itself. When a newer pose ends
/// that evaluation, the set-up goes on for a while even if another one is due.
void LiveDeformer::Impl::let_exact_pass() {
  std::unique_lock lock(mutex);
  const std::int64_t first = newest;
  changed.wait(lock, [&] {
    const bool due = deformer && newest > 0 && !refined && !refused && Clock::now() >= settled_at;
    return closed || !(exact_runs || due) || newest != first;
  });
}

/// If no proxy can be made, the exact set-up goes on without one. It reports any error in the region.
void LiveDeformer::Impl::make_proxy() {
  std::shared_ptr<const ProxyDeformer> made;
  DeformerOptions of_proxy = options.deformer;
  if (of_proxy.method == DeformMethod::shell && path != SolvePath::proxy)
    of_proxy.method = DeformMethod::corotational;  // its frames are quick, and the exact result follows
  try {
    made = std::make_shared<const ProxyDeformer>(problem, ProxyOptions{of_proxy, options.proxy_vertices},
                                                 behind("proxy"));
  } catch (const Error& error) {
    if (error.code() == ErrorCode::cancelled) throw;
    return;
  }
  {
    const std::lock_guard lock(mutex);
    proxy = std::move(made);
  }
  enter(LiveStage::preview);
}

void LiveDeformer::Impl::make_deformer() {
  auto made = earlier ? std::make_shared<const Deformer>(earlier->with_region(problem.region, behind()))
                      : std::make_shared<const Deformer>(problem, options.deformer, behind());
  earlier.reset();
  {
    const std::lock_guard lock(mutex);
    deformer = std::move(made);
  }
  enter(LiveStage::exact);
}

/// Makes the quick frames that replace the proxy, except for poses that they refuse.
void LiveDeformer::Impl::make_quick_frames() {
  const Context making = behind();
  std::shared_ptr<const HandleBasis> linear;
  std::shared_ptr<const ReducedFrames> near;
  try {
    if (options.deformer.method == DeformMethod::ft05)
      linear = std::make_shared<const HandleBasis>(*deformer, options.normals, making);
    else if (path == SolvePath::direct)  // iterations take too long for hundreds of columns
      near = std::make_shared<const ReducedFrames>(*deformer, options.reduced, making);
  } catch (...) {  // for any error, the exact deformer remains
    if (current_error().code() == ErrorCode::cancelled) throw;
  }
  std::shared_ptr<const ProxyDeformer> needless;  // destroyed after the lock is released
  {
    const std::lock_guard lock(mutex);
    basis = std::move(linear);
    reduced = std::move(near);
    if ((basis || reduced) && !has_curve) needless = std::move(proxy);
  }
  enter(LiveStage::ready);
}

void LiveDeformer::Impl::enter(LiveStage next) {
  const std::lock_guard lock(mutex);
  if (!closed) stage = next;
  changed.notify_all();
}

/// Keeps the proxy if the error is a lack of memory. Otherwise no frames are possible.
void LiveDeformer::Impl::give_up(const Error& error) {
  const std::lock_guard lock(mutex);
  if (closed) return;
  failure = error;
  if (error.code() == ErrorCode::memory && proxy) {
    stage = LiveStage::proxy_only;
  } else {
    stage = LiveStage::failed;
    proxy.reset();
  }
  changed.notify_all();
}

void LiveDeformer::Impl::show() {
  while (const std::optional<Job> job = next_job()) run(*job);
}

/// Returns the next job: the newest pose by the best quick method, then exactly once the pose rests.
std::optional<LiveDeformer::Impl::Job> LiveDeformer::Impl::next_job() {
  std::unique_lock lock(mutex);
  frames_thread = std::this_thread::get_id();
  while (!closed) {
    if (failure && !failure_told) {
      failure_told = true;
      const Error error = *failure;
      lock.unlock();
      if (callbacks.failed) callbacks.failed(0, error);
      lock.lock();
      continue;
    }
    if (newest > 0 && !refused) {
      std::optional<Answer> answer = quickest();
      if (answer && (!tried || *tried < answer->accuracy)) return take(std::move(*answer));
      if (deformer && (!tried || *tried < FrameAccuracy::exact)) {
        if (!tried || Clock::now() >= settled_at)
          return take({FrameAccuracy::exact, [exact = deformer](auto given, Points& out, const Context& how) {
                         exact->evaluate(given, out, how);
                       }});
        changed.wait_until(lock, settled_at);
        continue;
      }
    }
    if (reserved && Clock::now() < settled_at) {
      changed.wait_until(lock, settled_at);
      continue;
    }
    reserved.reset();
    changed.wait(lock);
  }
  reserved.reset();
  return std::nullopt;
}

std::optional<LiveDeformer::Impl::Answer> LiveDeformer::Impl::quickest() const {
  const bool redrawn =
      std::any_of(poses.begin(), poses.end(), [](const HandlePose& pose) { return pose.curve.has_value(); });
  if (basis && !redrawn)
    return Answer{FrameAccuracy::linear, [linear = basis](auto given, Points& out, const Context& how) {
                    linear->frame(given, out, nullptr, how);
                  }};
  if (reduced && !redrawn)
    return Answer{FrameAccuracy::reduced, [near = reduced](auto given, Points& out, const Context& how) {
                    near->frame(given, out, how);
                  }};
  if (proxy)
    return Answer{FrameAccuracy::proxy, [coarse = proxy](auto given, Points& out, const Context& how) {
                    coarse->evaluate(given, out, how);
                  }};
  return std::nullopt;
}

/// Starts a job. An exact evaluation that only refines may be stopped by a newer pose. The first frame of a
/// pose is always finished, because otherwise nothing would be seen while handles move. During the set-up a
/// quick frame uses one thread: its loops are short and would wait for busy threads. If such frames are slow, a
/// core is reserved for them until the handles rest.
LiveDeformer::Impl::Job LiveDeformer::Impl::take(Answer answer) {
  tried = answer.accuracy;
  exact_runs = answer.accuracy == FrameAccuracy::exact;
  const bool refines = exact_runs && shown;
  if (refines) refinement = std::stop_source();
  const bool alone = exact_runs || stage == LiveStage::ready || stage == LiveStage::proxy_only;
  if (alone)
    reserved.reset();
  else if (!reserved && slow_frames >= many_slow_frames)
    reserved.emplace();
  const Context how{alone ? context.threads : 1, {}, refines ? refinement.get_token() : stop.get_token()};
  return {newest, poses, std::move(answer), how};
}

void LiveDeformer::Impl::run(const Job& job) {
  const Stopwatch watch;
  try {
    const std::shared_ptr<Points> positions = pool->take();
    job.answer.evaluate(job.poses, *positions, job.context);
    if (job.answer.accuracy != FrameAccuracy::exact)
      slow_frames = watch.seconds() > slow_frame_seconds ? slow_frames + 1 : 0;
    deliver(job, {job.pose, positions, job.answer.accuracy, watch.seconds()});
  } catch (...) {
    refuse(job, current_error());
  }
  const std::lock_guard lock(mutex);
  exact_runs = false;
  changed.notify_all();
}

void LiveDeformer::Impl::deliver(const Job& job, const LiveFrame& computed) {
  LiveFrame frame = computed;
  const bool exact = frame.accuracy == FrameAccuracy::exact;
  frame.error_rel = exact ? 0.0 : measured[static_cast<std::size_t>(frame.accuracy)];
  callbacks.frame(frame);
  if (exact && last_quick.pose == frame.pose)
    if (const auto error = relative_error(*last_quick.positions, *frame.positions, problem.rest))
      measured[static_cast<std::size_t>(last_quick.accuracy)] = error;
  last_quick = exact ? LiveFrame() : std::move(frame);
  const std::lock_guard lock(mutex);
  if (job.pose != newest) return;
  shown = true;
  refined = exact;
  changed.notify_all();
}

/// Refuses a pose for all methods, because a pose that one method cannot compute fails in the others too.
void LiveDeformer::Impl::refuse(const Job& job, const Error& error) {
  if (error.code() == ErrorCode::cancelled && job.context.stop_token.stop_requested()) return;
  {
    const std::lock_guard lock(mutex);
    if (closed) return;
    if (job.pose == newest) refused = error;
    changed.notify_all();
  }
  if (callbacks.failed) callbacks.failed(job.pose, error);
}

LiveDeformer::LiveDeformer(DeformProblem problem, LiveCallbacks callbacks, const LiveOptions& options,
                           const Context& context)
    : impl_(std::make_unique<Impl>(std::move(problem), std::move(callbacks), options, context)) {
  impl_->start();
}

LiveDeformer::~LiveDeformer() = default;

std::int64_t LiveDeformer::drag(std::span<const HandlePose> poses) {
  Impl& d = *impl_;
  validate(poses, d.problem.region.handles);
  const auto settle = std::chrono::duration<double>(d.options.settle_seconds);
  std::vector<HandlePose> copy(poses.begin(), poses.end());
  const std::lock_guard lock(d.mutex);
  if (d.closed) return 0;
  if (d.newest > 0 && !d.tried) ++d.superseded;
  d.poses.swap(copy);
  d.settled_at = Clock::now() + std::chrono::duration_cast<Clock::duration>(settle);
  d.tried.reset();
  d.shown = d.refined = false;
  d.refused.reset();
  d.refinement.request_stop();
  d.changed.notify_all();
  return ++d.newest;
}

void LiveDeformer::wait_until_exact() const {
  const Impl& d = *impl_;
  std::unique_lock lock(d.mutex);
  const auto self = std::this_thread::get_id();
  if (self == d.frames_thread || self == d.setup_thread) throw Error(facts::deform::WaitInCallback{});
  d.changed.wait(lock, [&] {
    return d.closed || d.failure || d.refused || (d.newest > 0 ? d.refined : d.deformer != nullptr);
  });
  if (d.closed) throw Error(facts::deform::LiveDeformerClosed{});
  if (d.failure) throw Error(*d.failure);
  if (d.refused) throw Error(*d.refused);
}

LiveStage LiveDeformer::stage() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->stage;
}

std::int64_t LiveDeformer::superseded() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->superseded;
}

std::shared_ptr<const HandleBasis> LiveDeformer::basis() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->basis;
}

std::shared_ptr<const Deformer> LiveDeformer::deformer() const {
  const std::lock_guard lock(impl_->mutex);
  return impl_->deformer;
}

void LiveDeformer::close() { impl_->close(); }

}  // namespace meshgraft
