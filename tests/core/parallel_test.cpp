#include <meshgraft/core/parallel.h>

#include <atomic>
#include <cstddef>
#include <stdexcept>
#include <stop_token>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

namespace meshgraft {
namespace {

// Sizes around the grain: nothing, one block that is not full, exactly full ones, one index more.
struct Size {
  std::size_t count, grain;
};
constexpr Size sizes[] = {{0, 8}, {1, 8}, {7, 8}, {8, 8}, {9, 8}, {4096, 64}, {10007, 64}};

Context with_threads(int threads) { return {.threads = threads, .progress = {}, .stop_token = {}}; }

TEST(ParallelBlocks, VisitsEveryIndexOnce) {
  for (const auto [count, grain] : sizes)
    for (const int threads : {0, 1, 2, 4}) {
      std::vector<int> visits(count, 0);  // plain ints: a block that overlaps another is a data race too
      parallel_blocks(
          count,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) ++visits[i];
          },
          with_threads(threads), grain);
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " indices, " << threads << " threads";
    }
}

TEST(ParallelBlocks, PassesOnAnException) {
  for (const int threads : {1, 2, 4})
    EXPECT_THROW(parallel_blocks(
                     1000,
                     [](std::size_t begin, std::size_t) {
                       if (begin >= 500) throw std::out_of_range("late");
                     },
                     with_threads(threads), 10),
                 std::out_of_range);
}

TEST(ParallelBlocks, StopsWhenAsked) {
  for (const int threads : {1, 2, 4}) {
    std::stop_source stop;
    std::atomic<std::size_t> done = 0;
    const Context context{.threads = threads, .progress = {}, .stop_token = stop.get_token()};
    try {
      parallel_blocks(
          100000,
          [&](std::size_t begin, std::size_t end) {
            done += end - begin;
            stop.request_stop();
          },
          context, 10);
      ADD_FAILURE() << "went on to the end with " << threads << " threads";
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::cancelled);
      EXPECT_LT(done, 100000u);
    }
  }
}

TEST(Context, ReportsStagesAndThenStops) {
  std::stop_source stop;
  std::vector<double> fractions;
  const Context context{.threads = 0,
                        .progress = [&](std::string_view, double fraction) { fractions.push_back(fraction); },
                        .stop_token = stop.get_token()};
  context.step("factorise");
  context.step("factorise", 0.5);
  stop.request_stop();
  EXPECT_THROW(context.step("factorise", 1.0), Error);
  EXPECT_EQ(fractions.size(), 2u);
  EXPECT_LT(fractions.at(0), 0);
  EXPECT_EQ(fractions.at(1), 0.5);
}

}  // namespace
}  // namespace meshgraft
