#include "parallel.h"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <future>
#include <map>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <thread>
#include <utility>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>
#include <tbb/task_group.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"

#ifdef MESHGRAFT_SANITIZES_THREADS
#include <sanitizer/tsan_interface.h>
#endif

namespace meshgraft {

namespace {

// TBB's library is not instrumented, so ThreadSanitizer must be told the order of fork and join. The loop
// bodies come after the caller's earlier work, and the caller's next step comes after the bodies. The bodies
// stay unordered among themselves, so that a race between them is still found. Empty in other builds.
#ifdef MESHGRAFT_SANITIZES_THREADS
void signal(char& event) { __tsan_release(&event); }
void await(char& event) { __tsan_acquire(&event); }
#else
void signal(char&) {}
void await(char&) {}
#endif

struct ForkJoin {
  char fork = 0, join = 0;
  std::atomic<bool> body_threw = false;
};

// Whether the thread runs the body of a loop. A nested loop stays in the same arena.
thread_local bool in_body = false;

// Orders one body between the fork and the join, also when the body throws. It notes whether the body throws.
class BodyScope {
 public:
  explicit BodyScope(ForkJoin& events) : events_(events), was_in_body_(std::exchange(in_body, true)) {
    await(events_.fork);
  }
  ~BodyScope() {
    if (std::uncaught_exceptions() > exceptions_before_) events_.body_threw = true;
    signal(events_.join);
    in_body = was_in_body_;
  }
  BodyScope(const BodyScope&) = delete;
  BodyScope& operator=(const BodyScope&) = delete;

 private:
  ForkJoin& events_;
  bool was_in_body_;
  int exceptions_before_ = std::uncaught_exceptions();
};

// Orders the caller around the loop.
class CallerScope {
 public:
  explicit CallerScope(ForkJoin& events) : events_(events) { signal(events_.fork); }
  ~CallerScope() { await(events_.join); }
  CallerScope(const CallerScope&) = delete;
  CallerScope& operator=(const CallerScope&) = delete;

 private:
  ForkJoin& events_;
};

// Returns the thread's own arena of that size. An arena made for each loop is not released when several
// threads make them at once (oneTBB 2021.8), and each loop takes longer than the last. Measured: 20,000 short
// loops on each of two threads took 30 s and 290 MB instead of 0.1 s.
tbb::task_arena& arena_of(int threads) {
  thread_local std::map<int, tbb::task_arena> arenas;
  return arenas.try_emplace(threads, threads).first->second;
}

// Runs `work` on at most as many threads as the context allows. Throws Error(memory) if oneTBB cannot start
// its threads. oneTBB reports that by a plain std::runtime_error, which is its own where no body has thrown.
template <class Work>
void in_arena(const Context& context, const ForkJoin& events, const Work& work) {
  try {
    // Nested loops are isolated: the thread runs no body of the outer loop while it waits for the inner one.
    if (in_body)
      tbb::this_task_arena::isolate(work);
    else
      arena_of(worker_threads(context)).execute(work);
  } catch (const std::runtime_error&) {
    if (events.body_threw) throw;
    throw Error(facts::core::NoThreads{});
  }
}

// Ends tasks that a failure of another task has left without their results. It reaches no caller: the group
// of the task that failed throws that task's exception.
struct TasksLeftOut : std::exception {};

// Runs `work` for each number as a task of its own, in the thread's arena, and waits for all of them. Throws
// TasksLeftOut if TBB has cancelled the group because a task of an enclosing group failed.
void run_all(const std::vector<int>& numbers, const std::function<void(int)>& work) {
  if (numbers.empty()) return;
  ForkJoin events;
  const CallerScope caller(events);
  tbb::task_group group;
  for (const int number : numbers)
    group.run([&events, &work, number] {
      await(events.fork);
      work(number);
      signal(events.join);
    });
  if (group.wait() == tbb::task_group_status::canceled) throw TasksLeftOut();
}

}  // namespace

// Limits the threads to the cores: more gain nothing, and TBB warns about them on stderr.
int worker_threads(const Context& context) {
  const int cores = tbb::info::default_concurrency();
  return context.threads > 0 ? std::min(context.threads, cores) : cores;
}

void share_out(int count, const std::function<void(int, int)>& body, const Context& context) {
  const int shares = worker_threads(context);
  const auto begin = [&](int share) { return static_cast<int>(std::int64_t{count} * share / shares); };
  parallel_blocks(
      shares,
      [&](std::size_t first, std::size_t last) {
        for (auto share = static_cast<int>(first); share < static_cast<int>(last); ++share)
          body(begin(share), begin(share + 1));
      },
      context, 1);
}

void parallel_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     const Context& context, std::size_t grain) {
  context.throw_if_stopped();
  const auto run_blocks = [&](std::size_t first, std::size_t last) {
    for (std::size_t begin = first; begin < last; begin += grain) {
      context.throw_if_stopped();
      body(begin, begin + grain < last ? begin + grain : last);
    }
  };
  if (context.threads == 1 || count <= grain) {
    run_blocks(0, count);
    return;
  }
  ForkJoin events;
  const CallerScope caller(events);
  in_arena(context, events, [&] {
    // A range may be many blocks long: TBB divides it only as often as other threads are idle.
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      const BodyScope scope(events);
      run_blocks(range.begin(), range.end());
    });
  });
  context.throw_if_stopped();
}

namespace {

// How often a thread that waits for something else looks for a stop.
constexpr std::chrono::milliseconds between_looks(10);

// Counts the works that were left behind and still run.
class LeftBehind {
 public:
  static constexpr int most = 2;

  // Waits until few enough are left. Throws Error(cancelled) if a stop is requested before.
  void wait_for_room(const Context& context) {
    std::unique_lock lock(mutex_);
    while (count_ >= most) {
      context.throw_if_stopped();
      ended_.wait_for(lock, between_looks);
    }
  }
  void add(int count) {
    const std::lock_guard lock(mutex_);
    count_ += count;
    ended_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable ended_;
  int count_ = 0;
};

LeftBehind& left_behind() {
  static auto* const works = new LeftBehind;  // never destroyed: threads may outlive the main function
  return *works;
}

}  // namespace

void run_abandonable(std::function<void()> work, const Context& context) {
  context.throw_if_stopped();
  if (!context.stop_token.stop_possible()) {
    work();
    return;
  }
  left_behind().wait_for_room(context);
  // Either the work ends first or the caller leaves. The second of the two sees the first.
  const auto first_is_over = std::make_shared<std::atomic<bool>>(false);
  std::promise<void> promise;
  std::future<void> done = promise.get_future();
  std::jthread worker([work = std::move(work), promise = std::move(promise), first_is_over]() mutable {
    std::exception_ptr failure;
    try {
      work();
    } catch (...) {
      failure = std::current_exception();
    }
    work = nullptr;  // frees what it owns
    if (first_is_over->exchange(true)) left_behind().add(-1);
    if (failure)
      promise.set_exception(failure);
    else
      promise.set_value();
  });
  while (done.wait_for(between_looks) != std::future_status::ready) {
    if (!context.stop_token.stop_requested()) continue;
    left_behind().add(1);
    if (first_is_over->exchange(true)) left_behind().add(-1);
    worker.detach();
    context.throw_if_stopped();
  }
  done.get();
}

TaskForest::TaskForest(std::span<const int> parent, std::span<const double> work)
    : size_(static_cast<int>(parent.size())) {
  std::vector<double> below(work.begin(), work.end());
  double total = 0;
  for (int node = 0; node < size_; ++node) {
    total += work[node];
    if (parent[node] >= 0) below[parent[node]] += below[node];
  }
  constexpr double shares = 64;  // enough for a few threads to finish at about the same time
  const auto heavy = [&](int node) { return below[node] > total / shares; };
  std::vector<int> heavy_children(parent.size(), 0);
  for (int node = 0; node < size_; ++node)
    if (parent[node] >= 0 && heavy(node)) ++heavy_children[parent[node]];

  std::vector<int> task(parent.size());
  for (int node = size_ - 1; node >= 0; --node) {
    const int above = parent[node];
    const bool continues = above >= 0 && (!heavy(above) || (heavy(node) && heavy_children[above] == 1));
    if (continues) {
      task[node] = task[above];
    } else {
      task[node] = static_cast<int>(tasks_.size());
      tasks_.emplace_back();
      (above < 0 ? roots_ : tasks_[task[above]].below).push_back(task[node]);
    }
    tasks_[task[node]].nodes.push_back(node);
  }
}

void TaskForest::visit_up(const std::function<void(int)>& visit, const Context& context) const {
  if (context.threads == 1) {
    for (int node = 0; node < size_; ++node) {
      context.throw_if_stopped();
      visit(node);
    }
    return;
  }
  ForkJoin events;
  std::vector<char> visited(tasks_.size(), 0);
  const std::function<void(int)> climb = [&](int number) {
    const Task& task = tasks_[number];
    run_all(task.below, climb);
    for (const int below : task.below) await(visited[below]);
    const BodyScope scope(events);
    for (auto node = task.nodes.rbegin(); node != task.nodes.rend(); ++node) {
      context.throw_if_stopped();
      visit(*node);
    }
    signal(visited[number]);
  };
  const CallerScope caller(events);
  in_arena(context, events, [&] { run_all(roots_, climb); });
}

void TaskForest::visit_down(const std::function<void(int)>& visit, const Context& context) const {
  if (context.threads == 1) {
    for (int node = size_ - 1; node >= 0; --node) {
      context.throw_if_stopped();
      visit(node);
    }
    return;
  }
  ForkJoin events;
  std::vector<char> visited(tasks_.size(), 0);
  const std::function<void(int, char&)> descend = [&](int number, char& above) {
    await(above);
    const Task& task = tasks_[number];
    {
      const BodyScope scope(events);
      for (const int node : task.nodes) {
        context.throw_if_stopped();
        visit(node);
      }
      signal(visited[number]);
    }
    run_all(task.below, [&](int below) { descend(below, visited[number]); });
  };
  const CallerScope caller(events);
  in_arena(context, events, [&] { run_all(roots_, [&](int root) { descend(root, events.fork); }); });
}

}  // namespace meshgraft
