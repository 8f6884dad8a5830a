
#include <memory>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>
#include <meshgraft/linalg/linear_solver.h>

#include "linalg/blas_threads.h"
#include "matrix_families.h"

#if defined(__linux__) && !defined(MESHGRAFT_SANITIZES_ADDRESSES) && !defined(MESHGRAFT_SANITIZES_THREADS)
#define MESHGRAFT_CAN_LIMIT_ADDRESSES
#include <sys/resource.h>
#endif

#ifdef __ELF__
// Null in a program without OpenBLAS.
extern "C" {
__attribute__((weak)) int openblas_get_num_threads(void);
__attribute__((weak)) void openblas_set_num_threads(int count);
__attribute__((weak)) void* blas_memory_alloc(int unused);
}
#endif

namespace meshgraft {
namespace {

TEST(BetterBlasKernels, AreSomeThatOpenBlasHasOrNone) {
  const std::set<std::string> names{"", "Haswell", "SkylakeX"};
  EXPECT_TRUE(names.contains(better_blas_kernels())) << better_blas_kernels();
}

#ifdef __ELF__

/// Gives OpenBLAS two threads, and skips without it.
class SingleThreadedBlasTest : public testing::Test {
 protected:
  void SetUp() override {
    if (openblas_get_num_threads == nullptr) GTEST_SKIP() << "this program has no OpenBLAS";
    before_ = openblas_get_num_threads();
    openblas_set_num_threads(2);
    several_ = openblas_get_num_threads();  // 1 if this OpenBLAS has no threads
  }
  void TearDown() override {
    if (openblas_get_num_threads != nullptr) openblas_set_num_threads(before_);
  }
  int before_ = 1, several_ = 1;
};

TEST_F(SingleThreadedBlasTest, KeepsOneThreadUntilTheLastInstanceEnds) {
  auto first = std::make_unique<SingleThreadedBlas>(with_threads(1));
  EXPECT_EQ(openblas_get_num_threads(), 1);
  auto second = std::make_unique<SingleThreadedBlas>(with_threads(2));
  first.reset();  // ends before the one that began later
  EXPECT_EQ(openblas_get_num_threads(), 1);
  second.reset();
  EXPECT_EQ(openblas_get_num_threads(), several_);
}

TEST_F(SingleThreadedBlasTest, RestoresTheThreadsAfterInstancesOnSeveralThreads) {
  std::vector<std::jthread> threads;
  for (int thread = 0; thread < 4; ++thread)
    threads.emplace_back([] {
      for (int time = 0; time < 50; ++time) {
        const SingleThreadedBlas single_threaded(with_threads(1));
        EXPECT_EQ(openblas_get_num_threads(), 1);
      }
    });
  threads.clear();
  EXPECT_EQ(openblas_get_num_threads(), several_);
}

#ifdef MESHGRAFT_CAN_LIMIT_ADDRESSES

TEST_F(SingleThreadedBlasTest, RefusesWhatHasNoRoomForBuffers) {
  if (blas_memory_alloc == nullptr) GTEST_SKIP() << "this OpenBLAS does not tell how it maps buffers";
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_AS, &before), 0);
  rlimit none = before;
  none.rlim_cur = 1;  // what is mapped stays
  ASSERT_EQ(::setrlimit(RLIMIT_AS, &none), 0);
  std::string id;
  {
    std::vector<std::unique_ptr<SingleThreadedBlas>> users;
    try {
      while (users.size() < 100) users.push_back(std::make_unique<SingleThreadedBlas>(with_threads(1)));
    } catch (const Error& error) {
      id = error.id();
    }
  }
  ::setrlimit(RLIMIT_AS, &before);
  EXPECT_EQ(id, "linalg.no_room_for_buffers");
  EXPECT_EQ(openblas_get_num_threads(), several_);
  EXPECT_NO_THROW(SingleThreadedBlas(with_threads(1)));
}

#endif

#endif

}  // namespace
}  // namespace meshgraft
