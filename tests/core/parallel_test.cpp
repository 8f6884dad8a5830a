
#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <random>
#include <set>
#include <stdexcept>
#include <stop_token>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "core/reserved_core.h"

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
      std::vector<int> visits(count, 0);  // plain ints, so overlapping blocks are a data race, too
      parallel_blocks(
          count,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) ++visits[i];
          },
          with_threads(threads), grain);
      EXPECT_EQ(visits, std::vector<int>(count, 1)) << count << " indices, " << threads << " threads";
    }
}

TEST(ParallelBlocks, GivesNoBlockLongerThanTheGrain) {
  for (const int threads : {1, 2, 4})
    parallel_blocks(
        10'000, [](std::size_t begin, std::size_t end) { EXPECT_LE(end - begin, 64U); }, with_threads(threads),
        64);
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

TEST(ParallelBlocks, PassesOnAnExceptionOfTheTypeThatTbbThrows) {
  const auto broken = [](std::size_t, std::size_t) { throw std::runtime_error("broken"); };
  for (const int threads : {1, 2, 4}) {
    EXPECT_THROW(parallel_blocks(1000, broken, with_threads(threads), 10), std::runtime_error);
    const auto nested = [&](std::size_t, std::size_t) {
      parallel_blocks(100, broken, with_threads(threads), 10);
    };
    EXPECT_THROW(parallel_blocks(1000, nested, with_threads(threads), 10), std::runtime_error);
  }
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
                        .progress = [&](const Progress& progress) { fractions.push_back(progress.fraction); },
                        .stop_token = stop.get_token()};
  context.step("factorise");
  context.step("factorise", 0.5);
  stop.request_stop();
  EXPECT_THROW(context.step("factorise", 1.0), Error);
  EXPECT_EQ(fractions.size(), 2u);
  EXPECT_LT(fractions.at(0), 0);
  EXPECT_EQ(fractions.at(1), 0.5);
}

// Forests in postorder: a path, a star, many roots, a full binary tree, one at random, and a caterpillar.
std::vector<std::vector<int>> forests() {
  std::vector<std::vector<int>> all{{}, {-1}};
  std::vector<int> path, star, roots(300, -1), binary, random;
  for (int node = 0; node < 200'000; ++node) path.push_back(node < 199'999 ? node + 1 : -1);
  for (int node = 0; node < 300; ++node) star.push_back(node < 299 ? 299 : -1);
  const std::function<int(int)> grow = [&](int levels) {
    const int left = levels > 0 ? grow(levels - 1) : -1, right = levels > 0 ? grow(levels - 1) : -1;
    const int node = static_cast<int>(binary.size());
    binary.push_back(-1);
    if (left >= 0) binary[left] = binary[right] = node;
    return node;
  };
  grow(8);
  // A stack of roots; each new node takes some of them as its children.
  std::vector<int> open;
  std::minstd_rand generator(5);
  for (int node = 0; node < 1000; ++node) {
    random.push_back(-1);
    for (auto children = generator() % 3; children > 0 && !open.empty(); --children) {
      random[open.back()] = node;
      open.pop_back();
    }
    open.push_back(node);
  }
  // A path with a leaf at each node, so its depth grows with its size.
  std::vector<int> caterpillar;
  for (int node = 0; node < 200'000; node += 2) {
    caterpillar.push_back(node + 1);
    caterpillar.push_back(node + 3 < 200'000 ? node + 3 : -1);
  }
  for (auto* forest : {&path, &star, &roots, &binary, &random, &caterpillar}) all.push_back(*forest);
  return all;
}

TEST(TaskForest, VisitsEachNodeOnceAndChildrenOrParentsFirst) {
  for (const std::vector<int>& parent : forests()) {
    std::vector<double> work;
    for (std::size_t node = 0; node < parent.size(); ++node)
      work.push_back(1.0 + static_cast<double>(node % 7));
    const TaskForest forest(parent, work);
    for (const int threads : {1, 2, 4}) {
      // Plain sums over the nodes below (above) go wrong if a visit is too early, repeated or concurrent.
      std::vector<int> below(parent.size(), 0), above(parent.size(), 0), expected(parent.size(), 1);
      std::vector<std::vector<int>> children(parent.size());
      for (std::size_t node = 0; node < parent.size(); ++node)
        if (parent[node] >= 0) {
          children[parent[node]].push_back(static_cast<int>(node));
          expected[parent[node]] += expected[node];
        }
      forest.visit_up(
          [&](int node) {
            ++below[node];
            for (const int child : children[node]) below[node] += below[child];
          },
          with_threads(threads));
      EXPECT_EQ(below, expected);
      forest.visit_down([&](int node) { above[node] += 1 + (parent[node] < 0 ? 0 : above[parent[node]]); },
                        with_threads(threads));
      for (std::size_t node = 0; node < parent.size(); ++node)
        EXPECT_EQ(above[node], 1 + (parent[node] < 0 ? 0 : above[parent[node]]));
    }
  }
}

TEST(TaskForest, LetsAVisitShareOutItsOwnLoop) {
  const std::vector<int> parent{2, 2, 6, 5, 5, 6, -1};
  const TaskForest forest(parent, std::vector<double>(parent.size(), 1.0));
  std::vector<std::vector<int>> counts(parent.size(), std::vector<int>(5000, 0));
  forest.visit_up([&](int node) {
    parallel_blocks(5000, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) ++counts[node][i];
    });
  });
  for (const std::vector<int>& count : counts) EXPECT_EQ(count, std::vector<int>(5000, 1));
}

TEST(TaskForest, PassesOnAnExceptionAndStopsWhenAsked) {
  for (const std::vector<int>& parent : forests()) {
    if (parent.empty()) continue;
    const TaskForest forest(parent, std::vector<double>(parent.size(), 1.0));
    for (const int threads : {1, 2}) {
      const auto broken = [&](int node) {
        if (node == static_cast<int>(parent.size() / 2)) throw std::out_of_range("in the middle");
      };
      EXPECT_THROW(forest.visit_up(broken, with_threads(threads)), std::out_of_range);
      EXPECT_THROW(forest.visit_down(broken, with_threads(threads)), std::out_of_range);
      std::stop_source stop;
      stop.request_stop();
      const Context context{.threads = threads, .progress = {}, .stop_token = stop.get_token()};
      EXPECT_THROW(forest.visit_up([](int) {}, context), Error);
      EXPECT_THROW(forest.visit_down([](int) {}, context), Error);
    }
  }
}

// A failure cancels tasks that are still to come, also those whose results a task above them waits for.
TEST(TaskForest, VisitsNoNodeWithoutItsChildrenAfterAnException) {
  for (const std::vector<int>& parent : forests()) {
    if (parent.empty() || parent.size() > 10'000) continue;
    const TaskForest forest(parent, std::vector<double>(parent.size(), 1.0));
    std::vector<std::vector<int>> children(parent.size());
    for (std::size_t node = 0; node < parent.size(); ++node)
      if (parent[node] >= 0) children[parent[node]].push_back(static_cast<int>(node));
    for (std::size_t time = 0; time < 300; ++time) {
      const auto failing = static_cast<int>(time * parent.size() / 300);
      std::vector<std::atomic<int>> visited(parent.size());
      std::atomic<int> too_early = 0;
      EXPECT_THROW(forest.visit_up(
                       [&](int node) {
                         for (const int child : children[node]) too_early += visited[child] == 0 ? 1 : 0;
                         if (node == failing) throw std::out_of_range("here");
                         visited[node] = 1;
                       },
                       with_threads(2)),
                   std::out_of_range);
      EXPECT_EQ(too_early, 0);
    }
  }
}

TEST(ShareOut, CoversEverythingOnce) {
  for (const int count : {0, 1, 2, 3, 1000})
    for (const int threads : {0, 1, 2, 4}) {
      std::vector<int> visits(static_cast<std::size_t>(count), 0);
      share_out(
          count,
          [&](int begin, int end) {
            for (int i = begin; i < end; ++i) ++visits[i];
          },
          with_threads(threads));
      EXPECT_EQ(visits, std::vector<int>(static_cast<std::size_t>(count), 1));
    }
}

/// A loop of many short sleeps uses all threads that it may have.
TEST(ReservedCore, LeavesOneCoreToOthersWhileItExists) {
  const auto threads_of_a_loop = [] {
    std::mutex mutex;
    std::set<std::thread::id> ids;
    parallel_blocks(
        200,
        [&](std::size_t, std::size_t) {
          std::this_thread::sleep_for(std::chrono::microseconds(200));
          const std::lock_guard lock(mutex);
          ids.insert(std::this_thread::get_id());
        },
        {}, 1);
    return static_cast<int>(ids.size());
  };
  const int cores = worker_threads({});
  EXPECT_LE(threads_of_a_loop(), cores);
  {
    const ReservedCore reserved;
    EXPECT_LE(threads_of_a_loop(), std::max(1, cores - 1));
  }
  int most = 0;
  for (int time = 0; time < 100 && most < cores; ++time) most = std::max(most, threads_of_a_loop());
  EXPECT_EQ(most, cores);
}

TEST(RunAbandonable, StopsWaitingWhileTheWorkGoesOn) {
  std::stop_source stop;
  const Context context{.threads = 0, .progress = {}, .stop_token = stop.get_token()};
  struct Shared {
    std::promise<void> started, may_end, ended;
  };
  const auto shared = std::make_shared<Shared>();
  std::jthread other([&, shared] {
    shared->started.get_future().wait();
    stop.request_stop();
  });
  EXPECT_THROW(run_abandonable(
                   [shared] {
                     shared->started.set_value();
                     shared->may_end.get_future().wait();
                     shared->ended.set_value();
                   },
                   context),
               Error);
  shared->may_end.set_value();
  shared->ended.get_future().wait();  // hangs if the abandoned work does not end
}

TEST(RunAbandonable, StartsNothingWhileTwoWorksThatWereLeftStillRun) {
  struct Blocked {
    std::promise<void> started, may_end, ended;
  };
  std::vector<std::shared_ptr<Blocked>> left;
  for (int k = 0; k < 2; ++k) {
    const auto& blocked = left.emplace_back(std::make_shared<Blocked>());
    std::stop_source stop;
    std::jthread stopper([&] {
      blocked->started.get_future().wait();
      stop.request_stop();
    });
    EXPECT_THROW(run_abandonable(
                     [blocked] {
                       blocked->started.set_value();
                       blocked->may_end.get_future().wait();
                       blocked->ended.set_value();
                     },
                     {.threads = 0, .progress = {}, .stop_token = stop.get_token()}),
                 Error);
  }
  const auto released = std::make_shared<std::atomic<bool>>(false);
  const auto released_at_start = std::make_shared<std::atomic<bool>>(false);
  std::stop_source never;
  std::jthread third([&] {
    run_abandonable([=] { *released_at_start = released->load(); },
                    {.threads = 0, .progress = {}, .stop_token = never.get_token()});
  });
  for (int k = 0; k < 1000; ++k) std::this_thread::yield();  // the third call would start now if it could
  *released = true;
  for (const auto& blocked : left) {
    blocked->may_end.set_value();
    blocked->ended.get_future().wait();
  }
  third.join();
  EXPECT_TRUE(*released_at_start);
}

TEST(RunAbandonable, CanBeCancelledWhileItWaitsForWorksThatWereLeft) {
  struct Blocked {
    std::promise<void> started, may_end;
  };
  std::vector<std::shared_ptr<Blocked>> left;
  const auto leave = [&] {
    const auto& blocked = left.emplace_back(std::make_shared<Blocked>());
    std::stop_source stop;
    std::jthread stopper([&] {
      blocked->started.get_future().wait();
      stop.request_stop();
    });
    EXPECT_THROW(run_abandonable(
                     [blocked] {
                       blocked->started.set_value();
                       blocked->may_end.get_future().wait();
                     },
                     {.threads = 0, .progress = {}, .stop_token = stop.get_token()}),
                 Error);
  };
  leave();
  leave();
  std::stop_source stop;
  std::jthread stopper([&] { stop.request_stop(); });
  EXPECT_THROW(run_abandonable([] { FAIL() << "started beside two that were left"; },
                               {.threads = 0, .progress = {}, .stop_token = stop.get_token()}),
               Error);
  for (const auto& blocked : left) blocked->may_end.set_value();
}

TEST(RunAbandonable, RunsToTheEndAndPassesOnAnException) {
  std::stop_source stop;
  for (const Context& context :
       {Context{}, Context{.threads = 0, .progress = {}, .stop_token = stop.get_token()}}) {
    int calls = 0;
    run_abandonable([&] { ++calls; }, context);
    EXPECT_EQ(calls, 1);
    EXPECT_THROW(run_abandonable([] { throw std::out_of_range("wrong"); }, context), std::out_of_range);
  }
}

}  // namespace
}  // namespace meshgraft
