#include <meshgraft/core/parallel.h>

#include <algorithm>

#include <tbb/blocked_range.h>
#include <tbb/info.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#ifdef __SANITIZE_THREAD__
#include <sanitizer/tsan_interface.h>
#endif

namespace meshgraft {

namespace {

// TBB's library is not instrumented, so tsan has to be told that the bodies come after what the caller did
// before the loop, and the caller's next step after the bodies. Nothing orders the bodies among themselves:
// a race between them is still seen. Empty in other builds.
#ifdef __SANITIZE_THREAD__
void signal(char& event) { __tsan_release(&event); }
void await(char& event) { __tsan_acquire(&event); }
#else
void signal(char&) {}
void await(char&) {}
#endif

struct ForkJoin {
  char fork = 0, join = 0;
};

// Begins with the fork and ends with the join, also when the body throws.
class BodyScope {
 public:
  explicit BodyScope(ForkJoin& events) : events_(events) { await(events_.fork); }
  ~BodyScope() { signal(events_.join); }
  BodyScope(const BodyScope&) = delete;
  BodyScope& operator=(const BodyScope&) = delete;

 private:
  ForkJoin& events_;
};

// The same for the caller, around the loop.
class CallerScope {
 public:
  explicit CallerScope(ForkJoin& events) : events_(events) { signal(events_.fork); }
  ~CallerScope() { await(events_.join); }
  CallerScope(const CallerScope&) = delete;
  CallerScope& operator=(const CallerScope&) = delete;

 private:
  ForkJoin& events_;
};

}  // namespace

void parallel_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     const Context& context, std::size_t grain) {
  context.throw_if_stopped();
  if (context.threads == 1 || count <= grain) {
    for (std::size_t begin = 0; begin < count; begin += grain) {
      context.throw_if_stopped();
      body(begin, begin + grain < count ? begin + grain : count);
    }
    return;
  }
  // More threads than cores gain nothing, and TBB complains of them on stderr.
  const int cores = tbb::info::default_concurrency();
  tbb::task_arena arena(context.threads > 0 ? std::min(context.threads, cores) : cores);
  ForkJoin events;
  const CallerScope caller(events);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, count, grain), [&](const auto& range) {
      const BodyScope scope(events);
      context.throw_if_stopped();
      body(range.begin(), range.end());
    });
  });
}

}  // namespace meshgraft
