// Starts that a person would choose, on built-in models; starts_long_test.cpp has more.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "support/start_tasks.h"
#include "support/starts_found.h"

namespace meshgraft::test {
namespace {

TEST(StartsOfSamples, AreThoseThatAPersonWouldChoose) {
  StartsFound found;
  for (const StartTask& task : start_tasks(false, 4)) {
    SCOPED_TRACE(task.text);
    const std::vector<StartCandidate> starts = starts_of(task, true);
    double sum = 0;
    for (const StartCandidate& start : starts) sum += start.probability;
    EXPECT_LE(sum, 1 + 1e-9);
    EXPECT_LE(starts.size(), 5U);
    found.add(task, starts);
  }
  EXPECT_GE(found.count(), 10U);
  EXPECT_GE(found.right_first(), 0.7);  // few tasks; over all models it is 96 %
  EXPECT_GE(found.right_among_three(), 0.95);
}

TEST(StartsOfSamples, FollowWhatIsKnownOfTheModels) {
  for (StartTask& task : start_tasks(false, 2)) {
    SCOPED_TRACE(task.text);
    task.target_guesses = {{task.target_orientation}};
    task.source_guesses = {{task.source_orientation}};
    EXPECT_LE(start_error_deg(task, starts_of(task, true).front().start), 20);
  }
}

}  // namespace
}  // namespace meshgraft::test
