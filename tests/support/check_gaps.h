#pragma once

#include <stop_token>
#include <string>

namespace meshgraft::test {

/// Measures the processor time that threads spend between two checks for cancellation, `Context::step` and
/// `Context::throw_if_stopped`. A stop ends a call when each of its threads has come to its next check, so the
/// longest gap is the longest time from a request to the end of the call. Unlike that time it does not depend
/// on what else the machine does.
///
/// The program must be linked with `meshgraft_count_checks` (tests/support/CMakeLists.txt). One object may
/// exist at a time.
class CheckGaps {
 public:
  /// Starts to measure, with a check of the calling thread.
  CheckGaps();
  ~CheckGaps();
  CheckGaps(const CheckGaps&) = delete;
  CheckGaps& operator=(const CheckGaps&) = delete;

  /// Ends the calling thread's last gap. The end of a call counts as a check.
  void end();

  double longest_seconds() const;
  long checks() const;  ///< of all threads

  /// Requests a stop at the check of that number, counted from 1.
  void stop_at(long check, std::stop_source stop);

  /// The stage of the last report of progress before the longest gap; empty if there was none.
  std::string stage() const;
};

}  // namespace meshgraft::test
