#include "file.h"

#include <algorithm>
#include <memory>
#include <random>
#include <string>
#include <system_error>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/platform/file.h"
#include "core/platform/memory.h"

namespace meshgraft {

namespace {

namespace fs = std::filesystem;
using facts::io::Action;
using platform::File;
using platform::OpenMode;

/// Returns the fact of a failed system call: the file cannot be opened, read, …
Fact system_fault(Action action, const std::error_code& error) {
  const std::string reason = error.message();
  if (error == std::errc::no_such_file_or_directory)
    return facts::io::FileNotFound{.action = action, .reason = reason};
  if (error == std::errc::not_a_directory) return facts::io::NotAFolder{.action = action, .reason = reason};
  if (error == std::errc::permission_denied || error == std::errc::operation_not_permitted)
    return facts::io::NoPermission{.action = action, .reason = reason};
  if (platform::is_disk_full(error)) return facts::io::DiskFull{.action = action, .reason = reason};
  if (error == std::errc::file_too_large) return facts::io::FileTooLarge{.action = action, .reason = reason};
  if (error == std::errc::too_many_symbolic_link_levels)
    return facts::io::LinkLoop{.action = action, .reason = reason};
  if (error == std::errc::read_only_file_system) return facts::io::ReadOnly{.action = action, .reason = reason};
  if (error == std::errc::filename_too_long) return facts::io::NameTooLong{.action = action, .reason = reason};
  return facts::io::FileFailed{.action = action, .reason = reason};
}

[[noreturn]] void fail(const fs::path& path, Action action, const std::error_code& error) {
  throw io::file_error(path, action, error);
}

void require(const std::error_code& error, const fs::path& path, Action action) {
  if (error) fail(path, action, error);
}

/// Checks the error of a write, which a stop may have ended.
void require_written(const std::error_code& error, const fs::path& path) {
  if (error == std::errc::operation_canceled) throw Error(facts::core::Cancelled{});
  require(error, path, Action::write);
}

facts::io::Special special_of(fs::file_type type) {
  if (type == fs::file_type::fifo) return facts::io::Special::pipe;
  return type == fs::file_type::socket ? facts::io::Special::socket : facts::io::Special::device;
}

/// Refuses folders, pipes, devices and sockets.
void require_regular(fs::file_type type, const fs::path& path) {
  if (type == fs::file_type::directory) throw Error(facts::io::IsFolder{}, path);
  if (type != fs::file_type::regular) throw Error(facts::io::NotAFile{.special = special_of(type)}, path);
}

/// Refuses empty names and names with a NUL character. Names from an edit file or a mesh may be anything.
void require_name(const fs::path& path) {
  if (path.empty()) throw Error(facts::io::NoFileName{});
  if (path.native().find('\0') != fs::path::string_type::npos)
    throw Error(facts::io::NameWithNul{}, Location::file(path.c_str()));
}

}  // namespace

namespace io {

Error file_error(const fs::path& path, Action action, const std::error_code& error) {
  return {system_fault(action, error), path};
}

/// A temporary file in the folder of its target, removed again unless it became the target.
class PendingFile::TemporaryFile {
 public:
  explicit TemporaryFile(const fs::path& target) : target_(target), file_(create()) {}
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  ~TemporaryFile() { remove(); }

  void keep_permissions_of(const fs::path& old) {
    require(file_.copy_permissions(old), target_, Action::keep_permissions);
  }

  // Flushes piece by piece, because flushing a large file at once takes seconds on a slow disk.
  void fill(std::string_view content, const std::stop_token& stop) {
    constexpr std::size_t piece = std::size_t{16} << 20;
    do {
      require_written(file_.write(content.substr(0, piece), stop), target_);
      require(file_.flush(), target_, Action::flush);
      content.remove_prefix(std::min(content.size(), piece));
    } while (!content.empty());
    require(file_.close(), target_, Action::write);
  }

  void replace_target() {
    std::error_code error;
    fs::rename(path_, target_, error);
    require(error, target_, Action::replace);
    path_.clear();
    flush_folder();
  }

  /// Links the file to its target. Unlike rename, link fails if the target exists, so two writers cannot both
  /// believe to be the first. Returns false on file systems without hard links.
  bool become_new_target() {
    std::error_code error;
    fs::create_hard_link(path_, target_, error);
    if (error == std::errc::operation_not_permitted || error == std::errc::not_supported ||
        error == std::errc::function_not_supported)
      return false;
    require(error, target_, Action::create);
    remove();
    flush_folder();
    return true;
  }

 private:
  File create() {
    std::random_device random;
    for (int attempt = 0;; ++attempt) {
      path_ = target_.parent_path() / (".meshgraft-" + std::to_string(random()) + ".tmp");
      std::error_code error;
      File file(path_, OpenMode::create, error);
      if (!error) return file;
      if (error == std::errc::file_exists && attempt < 100) continue;
      path_.clear();
      fail(target_, Action::create, error);
    }
  }

  void remove() {
    std::error_code ignored;
    if (!path_.empty()) fs::remove(path_, ignored);
    path_.clear();
  }

  void flush_folder() const {
    platform::flush_folder(target_.parent_path().empty() ? fs::path(".") : target_.parent_path());
  }

  fs::path target_;
  fs::path path_;
  File file_;
};

}  // namespace io

namespace {

/// Writes directly to a pipe or a device, which has no old content to protect.
void write_through(const fs::path& path, std::string_view content, const std::stop_token& stop) {
  std::error_code error;
  File file(path, OpenMode::write, error);
  if (error == std::errc::no_such_device_or_address) throw Error(facts::io::NobodyReads{}, path);
  require(error, path, Action::open_for_writing);
  require_written(file.write(content, stop), path);
  require(file.close(), path, Action::write);
}

[[noreturn]] void refuse_existing(const fs::path& path) {
  throw Error(facts::io::FileExists{.file = path}, path);
}

}  // namespace

namespace io {

PendingFile::PendingFile(const fs::path& path, std::string_view content, Existing existing,
                         const std::stop_token& stop)
    : path_(path), target_(path), existing_(existing) {
  require_name(path);
  std::error_code error;
  const fs::file_status old = fs::status(path, error);
  const bool exists = fs::exists(old);
  if (!exists && error != std::errc::no_such_file_or_directory) fail(path, Action::write, error);
  if (fs::is_directory(old)) throw Error(facts::io::IsFolder{}, path);
  if (exists && !fs::is_regular_file(old)) {
    for_device_ = content;
    return;
  }
  if (exists && existing == Existing::refuse) refuse_existing(path);
  target_ = follow_links(path);  // not earlier: the link of /dev/stdout leads to no path
  // A rename would replace even a write-protected file.
  if (exists) require(platform::check_may_write(target_), path, Action::replace);
  temporary_ = std::make_unique<TemporaryFile>(target_);
  if (exists) temporary_->keep_permissions_of(path);
  temporary_->fill(content, stop);
}

PendingFile::PendingFile(PendingFile&&) noexcept = default;
PendingFile::~PendingFile() = default;

void PendingFile::appear(const std::stop_token& stop) {
  if (!temporary_) return write_through(target_, for_device_, stop);
  if (existing_ == Existing::refuse) {
    if (temporary_->become_new_target()) return;
    if (fs::exists(target_)) refuse_existing(path_);
  }
  temporary_->replace_target();
}

}  // namespace io

void write_file_atomically(const fs::path& path, std::string_view content, const Context& context) {
  io::PendingFile(path, content, io::Existing::replace, context.stop_token).appear(context.stop_token);
}

fs::path follow_links(fs::path path) {
  constexpr int most_links = 40;  // the limit of Linux
  std::error_code error;
  for (int k = 0; k < most_links && fs::is_symlink(path, error); ++k) {
    const fs::path next = fs::read_symlink(path, error);
    if (error) break;
    path = path.parent_path() / next;  // an absolute `next` replaces the folder
  }
  return path;
}

std::string read_file(const fs::path& path) {
  MemoryBudget budget{Context{}};
  return read_file(path, budget);
}

std::string read_file(const fs::path& path, MemoryBudget& budget, const Context& context) {
  require_name(path);
  std::error_code error;
  if (const fs::file_type type = fs::status(path, error).type(); type == fs::file_type::socket)
    require_regular(type, path);  // opening one fails
  File file(path, OpenMode::read, error);
  require(error, path, Action::open);
  const File::Status status = file.status(error);
  require(error, path, Action::read);
  require_regular(status.type, path);
  try {
    budget.charge(status.bytes);
  } catch (const Error& over) {
    throw over.at(path);
  }

  // Reads by pieces through a buffer that stays in the cache. Resizing the string to its full size first
  // would fill all of it with zeros.
  constexpr std::size_t piece = std::size_t{1} << 17;
  const auto buffer = std::make_unique_for_overwrite<char[]>(piece);
  std::string content;
  content.reserve(status.bytes);
  platform::prefer_huge_pages(content.data(), content.capacity());
  while (content.size() < status.bytes) {  // a file that grows meanwhile might never end
    context.throw_if_stopped();
    const std::size_t count =
        file.read(buffer.get(), std::min<std::size_t>(piece, status.bytes - content.size()), error);
    require(error, path, Action::read);
    if (count == 0) break;
    content.append(buffer.get(), count);
  }
  return content;
}

}  // namespace meshgraft
