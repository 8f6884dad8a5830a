// Grafts that nobody thought of are valid or refused; meshgraft_random_grafts makes more of them.
#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "support/random_grafts.h"

namespace meshgraft {
namespace {

TEST(RandomGrafts, AreValidOrRefused) {
  constexpr std::uint64_t count = 25;
  std::uint64_t refused = 0;
  for (std::uint64_t seed = 1; seed <= count; ++seed) {
    const test::RandomGraft graft = test::make_random_graft(seed);
    SCOPED_TRACE(testing::Message() << seed << ": " << graft.text);
    try {
      EXPECT_EQ(test::faults_of(graft, merge_meshes(graft.target, graft.source, graft.pairs, graft.options)),
                std::vector<std::string>());
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::input) << error.what();
      EXPECT_NE(error.remedy(), "") << error.what();
      ++refused;
    }
  }
  EXPECT_LT(refused, count / 4);
}

}  // namespace
}  // namespace meshgraft
