#pragma once

#include <cstdint>
#include <functional>
#include <stop_token>
#include <string_view>

namespace meshgraft {

/// The progress of a call. The texts are valid during the report.
struct Progress {
  std::string_view stage;  ///< identifier of the running stage; docs/architecture.md lists all of them
  double fraction = -1;    ///< of the stage that is done: 0 … 1, or negative where unknown
  /// The task that the stage belongs to, if a call does several: "proxy" for the stages of the proxy in
  /// LiveDeformer, the name of the method in a comparison; otherwise empty.
  std::string_view within{};
  int number = 0;  ///< number of that task, from 1; 0 if the tasks are not counted
  int count = 0;   ///< how many tasks there are; 0 if they are not counted
};

/// Reports progress on the calling thread. An exception that it throws ends the call.
using ProgressCallback = std::function<void(const Progress& progress)>;

/// Execution settings of a long call: threads, progress, cancellation and memory. It is passed to every long
/// call and never kept in a global. The result of a call does not depend on it.
struct Context {
  int threads = 0;               ///< worker threads; 0 = one per core
  ProgressCallback progress{};   ///< may be empty
  std::stop_token stop_token{};  ///< requests cancellation
  /// The most bytes that reading a file may take; 0: three quarters of the memory that the process may use.
  std::uint64_t memory = 0;

  /// Throws Error(cancelled) if a stop was requested; otherwise reports progress.
  void step(std::string_view stage, double fraction = -1.0) const;

  /// Throws Error(cancelled) if a stop was requested.
  void throw_if_stopped() const;

  /// Returns this context for one of `count` tasks: its progress names the task and its number, from 1. `task`
  /// must outlive the context.
  Context within(std::string_view task, int number, int count) const;
};

}  // namespace meshgraft
