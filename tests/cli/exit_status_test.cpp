#include "cli/exit_status.h"

#include <gtest/gtest.h>

namespace meshgraft::cli {
namespace {

TEST(ExitStatus, EveryCodeHasItsOwnAndFails) {
  const ErrorCode codes[] = {ErrorCode::usage,  ErrorCode::input,     ErrorCode::unsolvable, ErrorCode::io,
                             ErrorCode::memory, ErrorCode::cancelled, ErrorCode::internal};
  for (const ErrorCode a : codes) {
    EXPECT_GT(exit_status(a), 0);
    EXPECT_LT(exit_status(a), 256);
    for (const ErrorCode b : codes) EXPECT_EQ(exit_status(a) == exit_status(b), a == b);
  }
}

}  // namespace
}  // namespace meshgraft::cli
