#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>
#include <system_error>

namespace meshgraft::platform {

enum class OpenMode {
  read,              ///< an existing file or folder
  write,             ///< an existing file, pipe or device, from its beginning; its content stays
  create,            ///< a new file; fails where the path exists
  append,            ///< an existing file to append to and to read; fails at a symbolic link
  append_or_create,  ///< the same; a new file is readable and writable by its owner alone
};

/// An open file. It closes itself, is not handed on to programs that are started, and may be renamed or removed
/// while it is open. Its functions return the system's error, which is false where there was none.
class File {
 public:
  /// A file that is not open.
  File() = default;
  /// Opens a file; is not open where `error` says why not.
  File(const std::filesystem::path& path, OpenMode mode, std::error_code& error);
  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  bool is_open() const { return handle_ != no_handle; }
  /// Closes it. Some network disks report a failed write only now.
  std::error_code close();

  struct Status {
    std::filesystem::file_type type = std::filesystem::file_type::none;
    std::uint64_t bytes = 0;
  };
  Status status(std::error_code& error) const;

  /// Reads at most `size` bytes and returns how many; 0 at the end, and where there is an error.
  std::size_t read(char* buffer, std::size_t size, std::error_code& error);
  /// Writes all bytes, or as many as the system takes before an error.
  std::error_code write(std::string_view bytes);
  /// Waits until the disk has everything that was written.
  std::error_code flush();
  /// Cuts the file off, or extends it by zeros.
  std::error_code resize(std::uint64_t bytes);
  /// Gives it the permissions of another file, and its owner where this user may.
  std::error_code copy_permissions(const std::filesystem::path& from);

  /// Takes the file's lock, which one opening of it has at a time, until it is closed or the program ends;
  /// `std::errc::resource_unavailable_try_again` while another has it. Others may still read and write.
  std::error_code try_lock();
  /// Whether `path` names this file: it may have been removed or replaced since.
  bool is_at(const std::filesystem::path& path) const;

 private:
  static constexpr std::intptr_t no_handle = -1;
  std::intptr_t handle_ = no_handle;
};

/// Makes a folder's present names outlast a loss of power, where its file system can.
void flush_folder(const std::filesystem::path& folder);

/// The error that this user would get: writing to an existing file, and making files in a folder.
std::error_code check_may_write(const std::filesystem::path& file);
std::error_code check_may_create_in(const std::filesystem::path& folder);

/// Whether the disk is full, or this user's share of it.
bool is_disk_full(const std::error_code& error);

/// Makes a folder that only this user may enter, and returns its path: `stem` and random characters.
std::filesystem::path make_private_folder(const std::filesystem::path& stem, std::error_code& error);

}  // namespace meshgraft::platform
