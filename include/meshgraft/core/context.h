#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace meshgraft {

/// Reports progress on the calling thread. Its arguments are the running stage's name and the fraction of
/// that stage that is done (0 … 1, or negative where unknown). An exception that it throws ends the call.
using ProgressCallback = std::function<void(std::string_view stage, double fraction)>;

/// Execution settings of a long call: threads, progress and cancellation. It is passed to every long
/// call and never kept in a global. The result of a call does not depend on it.
struct Context {
  int threads = 0;               ///< worker threads; 0 = one per core
  ProgressCallback progress{};   ///< may be empty
  std::stop_token stop_token{};  ///< requests cancellation

  /// Reports progress and throws Error(cancelled) if a stop was requested.
  void step(std::string_view stage, double fraction = -1.0) const;

  /// Throws Error(cancelled) if a stop was requested.
  void throw_if_stopped() const;
};

}  // namespace meshgraft
