#include "core/platform/file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <string>
#include <utility>

namespace meshgraft::platform {

namespace fs = std::filesystem;

namespace {

std::error_code last_error() { return {errno, std::generic_category()}; }

std::error_code error_unless(bool success) { return success ? std::error_code() : last_error(); }

int flags_of(OpenMode mode) {
  switch (mode) {
    case OpenMode::read: return O_RDONLY | O_NONBLOCK;
    case OpenMode::write: return O_WRONLY | O_NONBLOCK;
    case OpenMode::create: return O_WRONLY | O_CREAT | O_EXCL;
    case OpenMode::append: return O_RDWR | O_APPEND | O_NOFOLLOW;
    case OpenMode::append_or_create: return O_RDWR | O_APPEND | O_NOFOLLOW | O_CREAT;
  }
  return O_RDONLY;
}

fs::file_type type_of(mode_t mode) {
  if (S_ISREG(mode)) return fs::file_type::regular;
  if (S_ISDIR(mode)) return fs::file_type::directory;
  if (S_ISFIFO(mode)) return fs::file_type::fifo;
  if (S_ISCHR(mode)) return fs::file_type::character;
  if (S_ISBLK(mode)) return fs::file_type::block;
  if (S_ISSOCK(mode)) return fs::file_type::socket;
  return fs::file_type::unknown;
}

int descriptor(std::intptr_t handle) { return static_cast<int>(handle); }

}  // namespace

File::File(const fs::path& path, OpenMode mode, std::error_code& error) {
  const mode_t permissions = mode == OpenMode::create ? 0666 : 0600;  // less the process's mask
  handle_ = ::open(path.c_str(), flags_of(mode) | O_CLOEXEC, permissions);
  error = error_unless(is_open());
}

File::File(File&& other) noexcept : handle_(std::exchange(other.handle_, no_handle)) {}

File& File::operator=(File&& other) noexcept {
  std::swap(handle_, other.handle_);
  return *this;
}

File::~File() {
  if (is_open()) ::close(descriptor(handle_));
}

std::error_code File::close() {
  return error_unless(::close(descriptor(std::exchange(handle_, no_handle))) == 0);
}

File::Status File::status(std::error_code& error) const {
  struct stat status = {};
  error = error_unless(::fstat(descriptor(handle_), &status) == 0);
  if (error) return {};
  return {type_of(status.st_mode), static_cast<std::uint64_t>(status.st_size)};
}

std::size_t File::read(char* buffer, std::size_t size, std::error_code& error) {
  for (;;) {
    const ssize_t count = ::read(descriptor(handle_), buffer, size);
    if (count < 0 && errno == EINTR) continue;
    error = error_unless(count >= 0);
    return error ? 0 : static_cast<std::size_t>(count);
  }
}

std::error_code File::write(std::string_view bytes, const std::stop_token& stop) {
  constexpr std::size_t largest_piece = std::size_t{1} << 24;  // a slow disk takes this in moments
  while (!bytes.empty()) {
    if (stop.stop_requested()) return std::make_error_code(std::errc::operation_canceled);
    const ssize_t count = ::write(descriptor(handle_), bytes.data(), std::min(bytes.size(), largest_piece));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0 && errno == EAGAIN) {
      constexpr int patience_ms = 50;
      pollfd writable = {descriptor(handle_), POLLOUT, 0};
      ::poll(&writable, 1, patience_ms);
      continue;
    }
    if (count < 0) return last_error();
    bytes.remove_prefix(count);
  }
  return {};
}

std::error_code File::flush() { return error_unless(::fsync(descriptor(handle_)) == 0); }

std::error_code File::resize(std::uint64_t bytes) {
  return error_unless(::ftruncate(descriptor(handle_), static_cast<off_t>(bytes)) == 0);
}

std::error_code File::copy_permissions(const fs::path& from) {
  struct stat other = {};
  if (::stat(from.c_str(), &other) != 0) return last_error();
  // Only root can give a file away, so keeping the owner is no failure.
  [[maybe_unused]] const int ignored = ::fchown(descriptor(handle_), other.st_uid, other.st_gid);
  return error_unless(::fchmod(descriptor(handle_), other.st_mode & 07777) == 0);
}

std::error_code File::try_lock() { return error_unless(::flock(descriptor(handle_), LOCK_EX | LOCK_NB) == 0); }

bool File::is_at(const fs::path& path) const {
  struct stat there = {}, here = {};
  return ::stat(path.c_str(), &there) == 0 && ::fstat(descriptor(handle_), &here) == 0 &&
         there.st_ino == here.st_ino && there.st_dev == here.st_dev;
}

void flush_folder(const fs::path& folder) {
  std::error_code ignored;
  File opened(folder, OpenMode::read, ignored);
  if (opened.is_open()) ignored = opened.flush();
}

std::error_code check_may_write(const fs::path& file) {
  return error_unless(::faccessat(AT_FDCWD, file.c_str(), W_OK, AT_EACCESS) == 0);
}

std::error_code check_may_create_in(const fs::path& folder) {
  return error_unless(::faccessat(AT_FDCWD, folder.c_str(), W_OK | X_OK, AT_EACCESS) == 0);
}

bool is_disk_full(const std::error_code& error) {
  return error == std::errc::no_space_on_device || error == std::error_code(EDQUOT, std::generic_category());
}

fs::path make_private_folder(const fs::path& stem, std::error_code& error) {
  std::string path = stem.string() + "XXXXXX";
  error = error_unless(::mkdtemp(path.data()) != nullptr);
  return path;
}

}  // namespace meshgraft::platform
