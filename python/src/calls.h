#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include <nanobind/nanobind.h>

#include <meshgraft/core/context.h>

namespace meshgraft::python {

namespace nb = nanobind;

/// Arguments of every long function: threads (0: all), the most bytes that reading may take (0: three quarters
/// of the memory), and None or a function of a stage and a fraction.
struct Call {
  int threads = 0;
  std::uint64_t memory = 0;
  nb::object progress = nb::none();
};

/// Reads the front's tuple (threads, memory, progress).
Call call_of(const nb::tuple& arguments);

/// Runs C++ work without the GIL on a parked thread. Meanwhile the calling thread looks for signals and
/// delivers progress every 50 ms. If a signal's handler or the progress function raises, the work is asked to
/// stop, and once it has, that exception is raised. `work` must not touch Python.
void run(const Call& call, const std::function<void(const Context&)>& work);

/// Runs short work without the GIL on the calling thread. It cannot be interrupted.
void run_short(const Call& call, const std::function<void(const Context&)>& work);

/// Runs work that returns a result.
template <class Work>
auto run_for(const Call& call, const Work& work) {
  std::optional<std::invoke_result_t<const Work&, const Context&>> result;
  run(call, [&](const Context& context) { result.emplace(work(context)); });
  return *std::move(result);
}

/// Returns the context of a call that reports no progress.
Context context_of(const Call& call);

/// Notes that this process is a fork of one that had loaded the module: it has none of that one's threads, and
/// oneTBB's do not come back. From then on everything runs on one thread.
void note_fork();

/// Returns the number of forks between the process that loaded the module and this one.
int fork_depth();

/// Throws RuntimeError if an object that owns threads was made before a fork.
void require_same_process(int depth_when_made, const char* what);

}  // namespace meshgraft::python
