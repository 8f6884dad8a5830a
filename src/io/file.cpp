#include "file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <memory>
#include <random>
#include <string>
#include <system_error>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/io/mesh_io.h>

namespace meshgraft {

namespace {

namespace fs = std::filesystem;

std::string reason(int error) { return std::generic_category().message(error); }

/// What a person can do about a failed system call on a file.
std::string remedy_for(int error) {
  switch (error) {
    case ENOENT: return "Check the spelling and the folder";
    case ENOTDIR: return "A part of the path is a file, not a folder";
    case EACCES:
    case EPERM: return "Change the permissions of the file or its folder, or choose another place";
    case ENOSPC:
    case EDQUOT: return "Free some space on the disk, or choose another place";
    case EFBIG: return "Files of that size cannot be written there; choose another place";
    case ELOOP: return "Links lead round in a circle there";
    case EROFS: return "The disk is read-only; choose another place";
    case ENAMETOOLONG: return "Choose a shorter name";
    default: return {};
  }
}

[[noreturn]] void fail(const fs::path& path, std::string_view what, int error) {
  throw Error(ErrorCode::io, std::string(what) + ": " + reason(error), path.string(), remedy_for(error));
}

/// Names from an edit file or a mesh may be anything.
void require_name(const fs::path& path) {
  if (path.empty()) throw Error(ErrorCode::io, "no file name is given");
  if (path.native().find('\0') != std::string::npos)
    throw Error(ErrorCode::io, "the name holds a NUL character", path.c_str(), "No file can be called so");
}

/// An open file that closes itself.
class Descriptor {
 public:
  explicit Descriptor(int fd) : fd_(fd) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd_ >= 0) ::close(fd_);
  }

  int get() const { return fd_; }
  bool valid() const { return fd_ >= 0; }

  /// Closing can report a write error that happened late (network disks): the writer has to look.
  bool close() { return ::close(std::exchange(fd_, -1)) == 0; }

 private:
  int fd_;
};

void write_all(int fd, std::string_view content, const fs::path& path) {
  constexpr std::size_t largest_piece = std::size_t{1} << 30;  // Linux moves at most 2 GiB per call
  while (!content.empty()) {
    const ssize_t written = ::write(fd, content.data(), std::min(content.size(), largest_piece));
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) fail(path, "cannot be written", errno);
    content.remove_prefix(static_cast<std::size_t>(written));
  }
}

}  // namespace

namespace io {

/// A temporary file in the folder of its target, removed again unless it became the target.
class PendingFile::TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : target_(target), descriptor_(create()) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() {
    if (!path_.empty()) ::unlink(path_.c_str());
  }

  void keep_permissions_of(const struct stat& old) {
    // The owner can only be kept by root; losing it is no reason to fail.
    if (::fchown(descriptor_.get(), old.st_uid, old.st_gid) != 0) errno = 0;
    if (::fchmod(descriptor_.get(), old.st_mode & 07777) != 0) {
      fail(target_, "cannot keep the permissions of the old file", errno);
    }
  }

  void fill(std::string_view content) {
    write_all(descriptor_.get(), content, target_);
    if (::fsync(descriptor_.get()) != 0) fail(target_, "cannot be flushed to the disk", errno);
    if (!descriptor_.close()) fail(target_, "cannot be written", errno);
  }

  void replace_target() {
    if (::rename(path_.c_str(), target_.c_str()) != 0) fail(target_, "cannot be replaced", errno);
    path_.clear();
    flush_folder();
  }

  /// Unlike rename, link fails where the target exists, so two writers cannot both believe to be the first.
  /// Returns false on file systems without hard links.
  bool become_new_target() {
    if (::link(path_.c_str(), target_.c_str()) != 0) {
      if (errno == EPERM || errno == ENOTSUP || errno == ENOSYS) return false;
      fail(target_, "cannot be created", errno);
    }
    ::unlink(path_.c_str());
    path_.clear();
    flush_folder();
    return true;
  }

 private:
  int create() {
    std::random_device random;
    for (int attempt = 0;; ++attempt) {
      path_ = target_.parent_path() / (".meshgraft-" + std::to_string(random()) + ".tmp");
      const int fd = ::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
      if (fd >= 0) return fd;
      const int error = errno;
      if (error == EEXIST && attempt < 100) continue;
      path_.clear();
      fail(target_, "cannot be created", error);
    }
  }

  /// Makes the new name survive a power cut; folders of some file systems cannot be flushed, which is fine.
  void flush_folder() const {
    const fs::path folder = target_.parent_path().empty() ? fs::path(".") : target_.parent_path();
    const Descriptor descriptor(::open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC));
    if (descriptor.valid() && ::fsync(descriptor.get()) != 0) errno = 0;
  }

  fs::path target_;
  fs::path path_;
  Descriptor descriptor_;
};

}  // namespace io

namespace {

/// Pipes and devices have no old content to protect: the bytes simply go there.
void write_through(const fs::path& path, std::string_view content) {
  Descriptor descriptor(::open(path.c_str(), O_WRONLY | O_CLOEXEC));
  if (!descriptor.valid()) fail(path, "cannot be opened for writing", errno);
  write_all(descriptor.get(), content, path);
  if (!descriptor.close()) fail(path, "cannot be written", errno);
}

[[noreturn]] void refuse_existing(const fs::path& path) {
  throw Error(ErrorCode::io, "the file exists already", path.string(),
              "Choose another name, or ask for it to be replaced");
}

}  // namespace

namespace io {

void prefer_huge_pages(const void* begin, std::size_t size) {
#ifdef MADV_HUGEPAGE
  constexpr std::uintptr_t page = 4096;
  const auto address = reinterpret_cast<std::uintptr_t>(begin);
  const std::uintptr_t first = (address + page - 1) / page * page;
  const std::uintptr_t last = (address + size) / page * page;
  if (last <= first || last - first < (std::size_t{1} << 23)) return;
  // A hint: where the system does not take it, nothing changes. NOLINTNEXTLINE(performance-no-int-to-ptr)
  if (::madvise(reinterpret_cast<void*>(first), last - first, MADV_HUGEPAGE) != 0) errno = 0;
#endif
}

PendingFile::PendingFile(const fs::path& path, std::string_view content, Existing existing)
    : path_(path), target_(path), existing_(existing) {
  require_name(path);
  struct stat old = {};
  const bool exists = ::stat(path.c_str(), &old) == 0;
  if (!exists && errno != ENOENT) fail(path, "cannot be written", errno);
  if (exists && S_ISDIR(old.st_mode))
    throw Error(ErrorCode::io, "is a folder", path.string(), "Give the name of a file in it");
  if (exists && !S_ISREG(old.st_mode)) {
    for_device_ = content;
    return;
  }
  if (exists && existing == Existing::refuse) refuse_existing(path);
  target_ = follow_links(path);  // not before: behind /dev/stdout is no path
  // A rename would replace even a write-protected file.
  if (exists && ::faccessat(AT_FDCWD, target_.c_str(), W_OK, AT_EACCESS) != 0)
    fail(path, "cannot be replaced", errno);
  temporary_ = std::make_unique<TemporaryFile>(target_);
  if (exists) temporary_->keep_permissions_of(old);
  temporary_->fill(content);
}

PendingFile::PendingFile(PendingFile&&) noexcept = default;
PendingFile::~PendingFile() = default;

void PendingFile::appear() {
  if (!temporary_) return write_through(target_, for_device_);
  if (existing_ == Existing::refuse) {
    if (temporary_->become_new_target()) return;
    if (fs::exists(target_)) refuse_existing(path_);
  }
  temporary_->replace_target();
}

void write_file(const fs::path& path, std::string_view content, Existing existing) {
  PendingFile(path, content, existing).appear();
}

}  // namespace io

void write_file_atomically(const fs::path& path, std::string_view content) {
  io::write_file(path, content, io::Existing::replace);
}

fs::path follow_links(fs::path path) {
  constexpr int most_links = 40;  // Linux follows as many
  std::error_code error;
  for (int k = 0; k < most_links && fs::is_symlink(path, error); ++k) {
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / next;  // an absolute one replaces the folder
  }
  return path;
}

std::string read_file(const fs::path& path) {
  require_name(path);
  const Descriptor descriptor(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
  if (!descriptor.valid()) fail(path, "cannot be opened", errno);
  struct stat status = {};
  if (::fstat(descriptor.get(), &status) != 0) fail(path, "cannot be read", errno);
  if (S_ISDIR(status.st_mode)) {
    throw Error(ErrorCode::io, "is a folder", path.string(), "Give the name of a file in it");
  }

  // Piece by piece through a buffer that stays in the cache: growing the string to its size first would fill
  // all of it with zeros.
  constexpr std::size_t piece = std::size_t{1} << 17;
  const auto buffer = std::make_unique_for_overwrite<char[]>(piece);
  std::string content;
  if (S_ISREG(status.st_mode)) {
    content.reserve(static_cast<std::size_t>(status.st_size));
    io::prefer_huge_pages(content.data(), content.capacity());
  }
  for (;;) {
    const ssize_t got = ::read(descriptor.get(), buffer.get(), piece);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail(path, "cannot be read", errno);
    if (got == 0) return content;
    content.append(buffer.get(), static_cast<std::size_t>(got));
  }
}

}  // namespace meshgraft
