#pragma once

#include <functional>
#include <stop_token>
#include <string_view>

namespace meshgraft {

/// Called on the calling thread with the running stage's name and the fraction of that stage that is done
/// (0 … 1; negative where it cannot be told). What it throws ends the call.
using ProgressCallback = std::function<void(std::string_view stage, double fraction)>;

/// How a long call should run: passed as the last argument everywhere, never kept in a global. The result
/// of a call does not depend on it.
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
