#pragma once

#include <vector>

#include <meshgraft/merge/merge_options.h>

#include "support/start_tasks.h"

namespace meshgraft::test {

/// Returns the starts that the library finds, given the guesses from the whole models, or from the pieces
/// alone.
std::vector<StartCandidate> starts_of(const StartTask& task, bool whole);

/// Counts how often the starts that are found are right, within 20°.
class StartsFound {
 public:
  void add(const StartTask& task, const std::vector<StartCandidate>& starts);

  std::size_t count() const { return found_.size(); }
  double right_first() const;
  double right_among_three() const;
  /// Returns the mean difference between the probability of the first start and how often it is right, over
  /// five classes of probability (expected calibration error).
  double calibration_error() const;

 private:
  struct Found {
    bool first = false, among_three = false;
    double probability = 0;
  };
  std::vector<Found> found_;
};

}  // namespace meshgraft::test
