
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>

#include <gtest/gtest.h>

#include "core/memory.h"

namespace meshgraft::test {
namespace {

/// A tree of control groups.
class ControlGroups : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directories(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name) << text << '\n';
  }
  std::uint64_t limit(const std::string& membership) const {
    write("cgroup", membership);
    return control_group_limit(folder_ / "cgroup", folder_);
  }

  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  std::filesystem::path folder_ =
      std::filesystem::path(testing::TempDir()) /
      (std::string("groups-") + testing::UnitTest::GetInstance()->current_test_info()->name());
};

TEST_F(ControlGroups, TheLeastOfAGroupAndThoseAboveItCounts) {
  write("user.slice/memory.max", "3000");
  write("user.slice/app.slice/memory.max", "max");
  write("user.slice/app.slice/editor.scope/memory.max", "5000");
  EXPECT_EQ(limit("0::/user.slice/app.slice/editor.scope"), 3000u);
  EXPECT_EQ(limit("0::/user.slice/app.slice"), 3000u);
  EXPECT_EQ(limit("0::/other.slice"), none);
  write("memory.max", "2000");
  EXPECT_EQ(limit("0::/other.slice"), 2000u);
  EXPECT_EQ(limit("0::/"), 2000u);
}

TEST_F(ControlGroups, VersionOneHasAControllerOfItsOwn) {
  write("memory/job/memory.limit_in_bytes", "7000");
  write("memory/memory.limit_in_bytes", "9223372036854771712");
  EXPECT_EQ(limit("12:cpu,cpuacct:/job\n4:memory:/job\n0::/"), 7000u);
  EXPECT_EQ(limit("4:memory:/"), 9223372036854771712u);
}

TEST_F(ControlGroups, FilesWithoutALimitSetNone) {
  EXPECT_EQ(limit(""), none);
  EXPECT_EQ(limit("no colons"), none);
  EXPECT_EQ(control_group_limit(folder_ / "absent", folder_), none);
  write("a/memory.max", "0");
  EXPECT_EQ(limit("0::/a"), none);
}

TEST(Memory, ThisProcessMayUseSome) {
  EXPECT_GT(available_memory(), 100'000'000u);
  EXPECT_LE(available_memory(), physical_memory());
}

}  // namespace
}  // namespace meshgraft::test
