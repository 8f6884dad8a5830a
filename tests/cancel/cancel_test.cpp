// Laws of cancelling, over all operations that take a Context.

#include <string>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "support/cancel_cases.h"
#include "support/check_gaps.h"

namespace meshgraft::test {
namespace {

Context stoppable(int threads, const std::stop_source& stop) {
  return {.threads = threads, .progress = {}, .stop_token = stop.get_token()};
}

/// Returns the number of checks that a call makes when it runs to the end.
long checks_of(const CancellableCall& call, int threads) {
  CheckGaps gaps;
  call(stoppable(threads, std::stop_source()));
  gaps.end();
  return gaps.checks();
}

class Cancelling : public testing::TestWithParam<int> {};

// The stop is requested at a check and must end the call there, on every thread at its next check.
TEST_P(Cancelling, EndsACallAtTheNextCheck) {
  constexpr Index vertices = 2'500;
  constexpr int moments = 5;
  const int threads = GetParam();
  for (const CancelCase& each : cancel_cases()) {
    SCOPED_TRACE(each.name);
    const CancellableCall call = each.prepare(vertices);
    const long all = checks_of(call, threads);
    EXPECT_GT(all, 0);
    for (int moment = 0; moment < moments; ++moment) {
      // Not near the end: with several threads the number of checks varies a little.
      const long at = 1 + (all - 1) * moment / (moments + 1);
      std::stop_source stop;
      CheckGaps gaps;
      gaps.stop_at(at, stop);
      try {
        call(stoppable(threads, stop));
        ADD_FAILURE() << "not cancelled at check " << at << " of " << all;
      } catch (const Error& error) {
        EXPECT_EQ(error.code(), ErrorCode::cancelled) << error.what();
      }
      gaps.end();
      constexpr long most_per_thread = 2;  // lib3mf asks again after a callback has told it to stop
      EXPECT_LE(gaps.checks() - at, most_per_thread * threads) << "at check " << at;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Threads, Cancelling, testing::Values(1, 2),
                         [](const auto& tested) { return std::to_string(tested.param); });

class CancellingLarge : public testing::TestWithParam<Index> {};

// The processor time between two checks of a thread bounds the time until a cancelled call ends.
TEST_P(CancellingLarge, IsCheckedOften) {
  constexpr double most_seconds = 0.15;
  for (const CancelCase& each : cancel_cases()) {
    if (GetParam() > each.most_vertices) continue;
    const CancellableCall call = each.prepare(GetParam());
    CheckGaps gaps;
    const auto kept = call(stoppable(0, std::stop_source()));
    gaps.end();
    EXPECT_LT(gaps.longest_seconds(), most_seconds) << each.name << ", in the stage " << gaps.stage();
  }
}

INSTANTIATE_TEST_SUITE_P(Sizes, CancellingLarge, testing::Values(50'000),
                         [](const auto& tested) { return std::to_string(tested.param); });

}  // namespace
}  // namespace meshgraft::test
