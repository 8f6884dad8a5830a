#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>

namespace meshgraft {

/// Returns whether a stop was requested. It serves callbacks of C libraries, which no exception may leave.
inline bool is_stop_requested(const Context& context) {
  try {
    context.throw_if_stopped();
    return false;
  } catch (const Error&) {
    return true;
  }
}

/// Checks for cancellation in a loop with many short steps: once in `between` of them. A step of a microsecond
/// makes 66 ms between two checks by default.
class SparseChecks {
 public:
  explicit SparseChecks(const Context& context, unsigned between = 1U << 16)
      : context_(context), between_(between) {}

  /// Counts a step. Throws Error(cancelled) if a stop was requested.
  void operator()() {
    if (++steps_ % between_ == 0) context_.throw_if_stopped();
  }

 private:
  const Context& context_;
  unsigned between_, steps_ = 0;
};

}  // namespace meshgraft
