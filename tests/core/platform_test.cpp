// Checks what the platform layer guarantees on every system for which it is implemented.
#include <algorithm>
#include <array>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <future>
#include <iterator>
#include <limits>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "core/memory.h"
#include "core/platform/file.h"
#include "core/platform/interrupt.h"
#include "core/platform/memory.h"
#include "core/platform/process.h"
#include "core/platform/processor.h"
#include "io/file.h"
#include "io/temporary_folder.h"

#ifdef __unix__
#include <sys/resource.h>
#endif

namespace meshgraft::test {
namespace {

namespace fs = std::filesystem;
using platform::File;
using platform::OpenMode;

File open(const fs::path& path, OpenMode mode) {
  std::error_code error;
  File file(path, mode, error);
  EXPECT_FALSE(error) << path << ": " << error.message();
  EXPECT_EQ(file.is_open(), !error);
  return file;
}

std::error_code refusal(const fs::path& path, OpenMode mode) {
  std::error_code error;
  EXPECT_FALSE(File(path, mode, error).is_open());
  return error;
}

std::string read_through(File& file, std::size_t piece) {
  std::string content;
  std::vector<char> buffer(piece);
  std::error_code error;
  while (const std::size_t count = file.read(buffer.data(), piece, error)) content.append(buffer.data(), count);
  EXPECT_FALSE(error) << error.message();
  return content;
}

TEST(PlatformFile, ReadsTheBytesThatWereWrittenInAnyPieces) {
  const TemporaryFolder folder;
  for (const std::size_t size : {0u, 1u, 4096u, 100'000u}) {
    std::string bytes(size, '\0');
    std::generate(bytes.begin(), bytes.end(), [k = 0]() mutable { return static_cast<char>(k++ * 31); });
    const fs::path path = folder / ("bytes-" + std::to_string(size)).c_str();
    File written = open(path, OpenMode::create);
    EXPECT_FALSE(written.write(bytes));
    EXPECT_FALSE(written.flush());
    EXPECT_FALSE(written.close());
    EXPECT_FALSE(written.is_open());
    for (const std::size_t piece : {7u, 65536u}) {
      File file = open(path, OpenMode::read);
      std::error_code error;
      const File::Status status = file.status(error);
      EXPECT_EQ(status.type, fs::file_type::regular);
      EXPECT_EQ(status.bytes, size);
      EXPECT_EQ(read_through(file, piece), bytes);
    }
  }
}

TEST(PlatformFile, CreatesOnlyWhatIsNotThere) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("old", "old"), missing = folder / "missing";
  EXPECT_EQ(refusal(path, OpenMode::create), std::errc::file_exists);
  EXPECT_EQ(refusal(missing, OpenMode::read), std::errc::no_such_file_or_directory);
  EXPECT_EQ(refusal(missing, OpenMode::write), std::errc::no_such_file_or_directory);
  EXPECT_EQ(refusal(missing, OpenMode::append), std::errc::no_such_file_or_directory);
  EXPECT_FALSE(fs::exists(missing));
  open(missing, OpenMode::append_or_create);
  EXPECT_TRUE(fs::exists(missing));
  EXPECT_EQ(read_file(path), "old");
}

TEST(PlatformFile, AppendsAndCutsOff) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("lines", "one\n");
  File file = open(path, OpenMode::append);
  EXPECT_FALSE(file.write("two\n"));
  EXPECT_EQ(read_file(path), "one\ntwo\n");
  EXPECT_FALSE(file.resize(4));
  EXPECT_FALSE(file.write("three\n"));
  EXPECT_EQ(read_file(path), "one\nthree\n");
  fs::create_symlink("lines", folder / "link");
  EXPECT_TRUE(refusal(folder / "link", OpenMode::append));
  EXPECT_TRUE(refusal(folder / "link", OpenMode::append_or_create));
}

TEST(PlatformFile, AFileForItsOwnerAloneIsThat) {
  const TemporaryFolder folder;
  open(folder / "journal", OpenMode::append_or_create);
  EXPECT_EQ(fs::status(folder / "journal").permissions(), fs::perms::owner_read | fs::perms::owner_write);
  std::error_code error;
  const fs::path one = platform::make_private_folder(folder / "room-", error),
                 other = platform::make_private_folder(folder / "room-", error);
  EXPECT_FALSE(error);
  EXPECT_NE(one, other);
  EXPECT_EQ(fs::status(one).permissions(), fs::perms::owner_all);
  EXPECT_TRUE(one.filename().string().starts_with("room-"));
  platform::make_private_folder(folder / "missing/room-", error);
  EXPECT_EQ(error, std::errc::no_such_file_or_directory);
}

TEST(PlatformFile, TakesPermissionsOver) {
  const TemporaryFolder folder;
  const fs::path from = folder.file("from", "");
  File file = open(folder / "to", OpenMode::create);
  for (const fs::perms permissions : {fs::perms(0600), fs::perms(0664), fs::perms(0755)}) {
    fs::permissions(from, permissions);
    EXPECT_FALSE(file.copy_permissions(from));
    EXPECT_EQ(fs::status(folder / "to").permissions(), permissions);
  }
}

TEST(PlatformFile, KnowsWhetherAPathIsStillItsOwn) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("one", "1"), other = folder.file("two", "2");
  File file = open(path, OpenMode::read);
  EXPECT_TRUE(file.is_at(path));
  EXPECT_FALSE(file.is_at(other));
  fs::rename(path, folder / "moved");
  EXPECT_TRUE(file.is_at(folder / "moved"));
  EXPECT_FALSE(file.is_at(path));
  fs::rename(other, path);
  EXPECT_FALSE(file.is_at(path));
  fs::remove(folder / "moved");
  EXPECT_FALSE(file.is_at(folder / "moved"));
  EXPECT_EQ(read_through(file, 16), "1");
}

/// A reader that opens a path while it is replaced sees one of its contents, whole.
TEST(PlatformFile, ReplacementShowsOldOrNew) {
  const TemporaryFolder folder;
  const fs::path path = folder / "out";
  const std::array<std::string, 2> contents = {std::string(50'000, 'a'), std::string(70'000, 'b')};
  write_file_atomically(path, contents[0]);
  auto writer = std::async(std::launch::async, [&] {
    for (int k = 1; k <= 50; ++k) write_file_atomically(path, contents[k % 2]);
  });
  for (int k = 0; k < 500; ++k) {
    const std::string seen = read_file(path);
    ASSERT_TRUE(seen == contents[0] || seen == contents[1]) << seen.size() << " bytes";
  }
  writer.get();
  EXPECT_TRUE(read_file(path) == contents[0]);
  EXPECT_EQ(folder.entry_count(), 1u);
}

TEST(PlatformFile, RefusesWhatIsNotThere) {
  const TemporaryFolder folder;
  EXPECT_FALSE(platform::check_may_write(folder.file("file", "")));
  EXPECT_FALSE(platform::check_may_create_in(folder.path()));
  EXPECT_EQ(platform::check_may_write(folder / "missing"), std::errc::no_such_file_or_directory);
  EXPECT_EQ(platform::check_may_create_in(folder / "missing"), std::errc::no_such_file_or_directory);
  EXPECT_TRUE(platform::is_disk_full(std::make_error_code(std::errc::no_space_on_device)));
  EXPECT_FALSE(platform::is_disk_full(std::make_error_code(std::errc::file_too_large)));
  EXPECT_FALSE(platform::is_disk_full({}));
}

constexpr int free_code = 10, locked_code = 11, other_code = 12;

/// Ends the process with a code that tells whether it could lock the file.
[[noreturn]] void exit_with_lock_state(const fs::path& path) {
  std::error_code error;
  File file(path, OpenMode::append, error);
  if (!error) error = file.try_lock();
  if (!error) std::_Exit(free_code);
  std::_Exit(error == std::errc::resource_unavailable_try_again ? locked_code : other_code);
}

TEST(PlatformFileDeathTest, ALockExcludesOthersUntilItsFileIsClosed) {
  const TemporaryFolder folder;
  const fs::path path = folder.file("journal", "line\n");
  File file = open(path, OpenMode::append);
  EXPECT_EXIT(exit_with_lock_state(path), testing::ExitedWithCode(free_code), "");
  EXPECT_FALSE(file.try_lock());
  EXPECT_EXIT(exit_with_lock_state(path), testing::ExitedWithCode(locked_code), "");
  File second = open(path, OpenMode::append);  // the lock excludes other openings by the same process, too
  EXPECT_EQ(second.try_lock(), std::errc::resource_unavailable_try_again);
  EXPECT_EQ(read_file(path), "line\n");

  File moved = std::move(file);
  EXPECT_EXIT(exit_with_lock_state(path), testing::ExitedWithCode(locked_code), "");
  EXPECT_FALSE(moved.close());
  EXPECT_FALSE(second.try_lock());
  EXPECT_FALSE(second.close());
  EXPECT_EXIT(exit_with_lock_state(path), testing::ExitedWithCode(free_code), "");
}

TEST(PlatformMemory, AddressSpaceIsThereOrNot) {
  EXPECT_TRUE(platform::can_reserve_address_space(std::size_t{1} << 20));
  EXPECT_FALSE(platform::can_reserve_address_space(std::numeric_limits<std::size_t>::max() / 2));
}

#ifdef __unix__
TEST(PlatformMemoryDeathTest, ALimitOfTheProcessCounts) {
  constexpr std::size_t limit = std::size_t{64} << 20;
  const auto exit_under_limit = [] {
    const rlimit low{limit, limit};
    bool holds = ::setrlimit(RLIMIT_AS, &low) == 0 && platform::process_memory_limit() == limit &&
                 !platform::can_reserve_address_space(limit);
#if !defined(MESHGRAFT_SANITIZES_ADDRESSES) && \
    !defined(MESHGRAFT_SANITIZES_THREADS)  // sanitizers need more to open a file
    holds = holds && available_memory() <= limit;
#endif
    std::_Exit(holds ? 0 : 1);
  };
  EXPECT_EXIT(exit_under_limit(), testing::ExitedWithCode(0), "");
}
#endif

TEST(PlatformMemory, AWishForHugePagesChangesNothing) {
  std::vector<char> bytes(std::size_t{20} << 20, 'x');
  platform::prefer_huge_pages(bytes.data(), 0);
  platform::prefer_huge_pages(bytes.data() + 1, 100);
  platform::prefer_huge_pages(bytes.data() + 1, bytes.size() - 1);
  EXPECT_EQ(std::count(bytes.begin(), bytes.end(), 'x'), static_cast<std::ptrdiff_t>(bytes.size()));
}

TEST(PlatformProcess, ItsEnvironmentCanBeSet) {
  constexpr const char* name = "MESHGRAFT_PLATFORM_TEST";
  for (const char* value : {"one", "two", ""}) {
    EXPECT_TRUE(platform::set_environment_variable(name, value));
    ASSERT_NE(std::getenv(name), nullptr);
    EXPECT_STREQ(std::getenv(name), value);
  }
  EXPECT_FALSE(platform::set_environment_variable("", "value"));
}

#ifdef __linux__
TEST(PlatformProcessDeathTest, RestartsItsProgramWithOtherArguments) {
  const auto restart = [] {
    std::string program = "core_test", nothing = "--gtest_filter=-*";
    std::array<char*, 3> arguments{program.data(), nothing.data(), nullptr};
    platform::restart_program(arguments.data());
    std::_Exit(1);
  };
  EXPECT_EXIT(restart(), testing::ExitedWithCode(0), "");
}

TEST(PlatformProcessDeathTest, AClosedPipeDoesNotEndIt) {
  const auto write_to_closed_pipe = [] {
    platform::report_failed_writes();
    std::raise(SIGPIPE);
    std::raise(SIGXFSZ);
    std::_Exit(0);
  };
  EXPECT_EXIT(write_to_closed_pipe(), testing::ExitedWithCode(0), "");
}

TEST(PlatformProcessor, SaysWhatTheSystemSays) {
  std::ifstream file("/proc/cpuinfo");
  const std::string text(std::istreambuf_iterator<char>(file), {});
  const auto has = [&](const char* flag) { return text.find(" " + std::string(flag)) != std::string::npos; };
  const auto expected = has("avx512f") && has("avx512dq") && has("avx512bw") && has("avx512vl")
                            ? platform::VectorInstructions::avx512
                        : has("avx2") && has("fma") ? platform::VectorInstructions::avx2
                                                    : platform::VectorInstructions::baseline;
  EXPECT_EQ(platform::vector_instructions(), expected);
}
#endif

TEST(PlatformInterrupt, EachRequestToEndIsPassedOnAndEndsNothing) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    std::array<std::promise<void>, 3> passed_on;
    std::size_t next = 0;
    const platform::InterruptWatch watch([&] { passed_on.at(next++).set_value(); });
    for (std::promise<void>& one : passed_on) {
      ASSERT_EQ(std::raise(signal), 0);
      one.get_future().wait();
    }
  }
}

TEST(PlatformInterruptDeathTest, WithoutAWatchARequestEndsTheProgram) {
  const auto end = [] {
    {
      const platform::InterruptWatch watch([] {});
    }
    std::raise(SIGTERM);
    std::_Exit(0);
  };
  EXPECT_EXIT(end(), testing::KilledBySignal(SIGTERM), "");
}

TEST(Platform, KnowsAVirtualMachineAsTheKernelDoes) {
  std::ifstream file("/proc/cpuinfo");
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (text.find("flags") == std::string::npos) GTEST_SKIP() << "the kernel lists no flags of the processor";
  EXPECT_EQ(platform::is_virtual_machine(), text.find(" hypervisor") != std::string::npos);
}

}  // namespace
}  // namespace meshgraft::test
