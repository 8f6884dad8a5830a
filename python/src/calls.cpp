#include "calls.h"

#include <chrono>
#include <condition_variable>
#include <exception>
#include <memory>
#include <mutex>
#include <stdexcept>
#include <stop_token>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace meshgraft::python {

namespace {

constexpr std::chrono::milliseconds between_looks(50);

int forks = 0;

// A thread that waits for work. It keeps oneTBB's arena from call to call.
class Worker {
 public:
  Worker() {
    std::thread([this] { serve(); }).detach();
  }

  void start(std::function<void()> job) {
    {
      const std::lock_guard lock(mutex_);
      job_ = std::move(job);
    }
    wake_.notify_one();
  }

 private:
  void serve() {
    for (;;) {
      std::function<void()> job;
      {
        std::unique_lock lock(mutex_);
        wake_.wait(lock, [this] { return job_ != nullptr; });
        job = std::exchange(job_, nullptr);
      }
      job();
    }
  }

  std::mutex mutex_;
  std::condition_variable wake_;
  std::function<void()> job_;
};

// Workers that have nothing to do. Neither they nor the list are ever destroyed: their threads run until the
// process ends.
struct Idle {
  std::mutex mutex;
  std::vector<Worker*> workers;
};
Idle* idle = new Idle;

Worker* take_worker() {
  const std::lock_guard lock(idle->mutex);
  if (idle->workers.empty()) return new Worker;
  Worker* const worker = idle->workers.back();
  idle->workers.pop_back();
  return worker;
}

void give_back(Worker* worker) {
  const std::lock_guard lock(idle->mutex);
  idle->workers.push_back(worker);
}

struct Report {
  std::string stage, within;
  double fraction;
  int number, count;
};

// The state of a call. Its two threads share it.
struct Shared {
  std::mutex mutex;
  std::condition_variable changed;
  bool done = false;
  std::exception_ptr error;
  std::vector<Report> reports;  // not delivered yet; the newest of each stage

  void add(const Progress& progress) {
    const std::lock_guard lock(mutex);
    if (reports.empty() || reports.back().stage != progress.stage || reports.back().within != progress.within)
      reports.emplace_back();
    reports.back() = {std::string(progress.stage), std::string(progress.within), progress.fraction,
                      progress.number, progress.count};
  }
};

void deliver(const std::vector<Report>& reports, const nb::object& progress) {
  for (const Report& report : reports) {
    const nb::object fraction =
        report.fraction < 0 ? nb::object(nb::none()) : nb::object(nb::float_(report.fraction));
    const std::string stage = report.within.empty() ? report.stage : report.within + ": " + report.stage;
    progress(nb::str(stage.c_str(), stage.size()), fraction);
  }
}

}  // namespace

Call call_of(const nb::tuple& arguments) {
  Call call;
  call.threads = nb::cast<int>(arguments[0]);
  call.memory = nb::cast<std::uint64_t>(arguments[1]);
  call.progress = arguments[2];
  return call;
}

Context context_of(const Call& call) {
  Context context;
  context.threads = forks > 0 ? 1 : call.threads;
  context.memory = call.memory;
  return context;
}

void run(const Call& call, const std::function<void(const Context&)>& work) {
  const auto shared = std::make_shared<Shared>();
  std::stop_source stop;
  Context context = context_of(call);
  context.stop_token = stop.get_token();
  if (!call.progress.is_none())
    context.progress = [shared](const Progress& progress) { shared->add(progress); };

  Worker* const worker = take_worker();
  worker->start([shared, &work, &context] {
    std::exception_ptr error;
    try {
      work(context);
    } catch (...) {
      error = std::current_exception();
    }
    const std::lock_guard lock(shared->mutex);
    shared->error = std::move(error);
    shared->done = true;
    shared->changed.notify_one();
  });

  std::exception_ptr raised;  // by Python, on this thread
  for (bool done = false; !done;) {
    std::vector<Report> reports;
    {
      const nb::gil_scoped_release release;
      std::unique_lock lock(shared->mutex);
      done = shared->changed.wait_for(lock, between_looks, [&] { return shared->done; });
      reports.swap(shared->reports);
    }
    if (raised) continue;
    try {
      deliver(reports, call.progress);
      if (PyErr_CheckSignals() != 0) nb::raise_python_error();
    } catch (...) {
      raised = std::current_exception();
      stop.request_stop();
    }
  }
  give_back(worker);
  if (raised) std::rethrow_exception(raised);
  if (shared->error) std::rethrow_exception(std::exchange(shared->error, nullptr));
}

void run_short(const Call& call, const std::function<void(const Context&)>& work) {
  const nb::gil_scoped_release release;
  work(context_of(call));
}

void note_fork() {
  ++forks;
  idle = new Idle;  // the old workers' threads are not in this process
}

int fork_depth() { return forks; }

void require_same_process(int depth_when_made, const char* what) {
  if (depth_when_made == forks) return;
  throw std::runtime_error(
      std::string(what) +
      " was made before this process forked, and its threads are not in this process. Make a new one "
      "here, or start processes with multiprocessing's method 'spawn'.");
}

}  // namespace meshgraft::python
