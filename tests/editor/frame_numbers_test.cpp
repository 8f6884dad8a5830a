#include "editor/frame_numbers.h"

#include <atomic>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

namespace meshgraft::test {
namespace {

using editor::FrameNumbers;

TEST(FrameNumbers, GoOnAfterThoseOfOtherSetUps) {
  std::vector<std::int64_t> sent;
  const auto send = [&](std::int64_t number) { sent.push_back(number); };
  FrameNumbers numbers(5);
  numbers.number(1, send);
  EXPECT_EQ(numbers.park(), 5);
  numbers.number(2, send);
  numbers.resume(11);
  numbers.number(3, send);
  EXPECT_EQ(sent, (std::vector<std::int64_t>{6, 14}));
}

// The page would take a late frame for one of the mesh that it was sent meanwhile.
TEST(FrameNumbers, AParkedSetUpHasSentItsLastFrame) {
  for (int round = 0; round < 5; ++round) {
    FrameNumbers numbers(0);
    std::atomic<bool> begun = false, parks = false, is_sending = false;
    const std::jthread deformer([&] {
      numbers.number(1, [&](std::int64_t) {
        is_sending = true;
        begun = true;
        while (!parks) std::this_thread::yield();
        for (int wait = 0; wait < 20; ++wait) std::this_thread::yield();
        is_sending = false;
      });
    });
    while (!begun) std::this_thread::yield();
    parks = true;
    numbers.park();
    ASSERT_FALSE(is_sending) << "in round " << round;
  }
}

}  // namespace
}  // namespace meshgraft::test
