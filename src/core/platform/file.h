#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <stop_token>
#include <string_view>
#include <system_error>

namespace meshgraft::platform {

enum class OpenMode {
  read,    ///< an existing file or folder; opening a pipe waits for no writer
  write,   ///< an existing file, pipe or device, from its beginning; it is not truncated. Opening a pipe
           ///< without a reader fails
  create,  ///< a new file; fails if the path exists
  append,  ///< an existing file, for reading and appending; fails at a symbolic link
  append_or_create,  ///< like `append`, or a new file that only its owner may read and write
};

/// An open file, closed by the destructor. Started programs do not inherit it, and it may be renamed or
/// removed while it is open. Functions that return std::error_code return the system's error, or an empty
/// code on success.
class File {
 public:
  /// Constructs a file that is not open.
  File() = default;
  /// Opens a file. On failure sets `error` and leaves the file closed.
  File(const std::filesystem::path& path, OpenMode mode, std::error_code& error);
  File(File&& other) noexcept;
  File& operator=(File&& other) noexcept;
  ~File();

  bool is_open() const { return handle_ != no_handle; }
  /// Closes the file. Some network disks report a failed write only at this point.
  std::error_code close();

  struct Status {
    std::filesystem::file_type type = std::filesystem::file_type::none;
    std::uint64_t bytes = 0;
  };
  Status status(std::error_code& error) const;

  /// Reads at most `size` bytes and returns how many; 0 at the end of the file and on an error.
  std::size_t read(char* buffer, std::size_t size, std::error_code& error);
  /// Writes all bytes, or as many as the system accepts before an error. Returns
  /// `std::errc::operation_canceled` if a stop is requested before the last bytes are written.
  std::error_code write(std::string_view bytes, const std::stop_token& stop = {});
  /// Waits until all written bytes are on the disk.
  std::error_code flush();
  /// Truncates the file, or extends it with zeros.
  std::error_code resize(std::uint64_t bytes);
  /// Copies the permissions of another file, and its owner if this user may do so.
  std::error_code copy_permissions(const std::filesystem::path& from);

  /// Takes the exclusive lock of the file, which lasts until the file is closed or the program ends. Returns
  /// `std::errc::resource_unavailable_try_again` if another opening of the file holds the lock. Others may
  /// still read and write.
  std::error_code try_lock();
  /// Returns whether `path` names this file; the file may have been removed or replaced since it was opened.
  bool is_at(const std::filesystem::path& path) const;

 private:
  static constexpr std::intptr_t no_handle = -1;
  std::intptr_t handle_ = no_handle;
};

/// Makes the current names in a folder survive a power failure, if the file system supports it.
void flush_folder(const std::filesystem::path& folder);

/// Return the error that this user would get on writing to an existing file, or on creating files in a
/// folder.
std::error_code check_may_write(const std::filesystem::path& file);
std::error_code check_may_create_in(const std::filesystem::path& folder);

/// Returns whether the error says that the disk or this user's quota is full.
bool is_disk_full(const std::error_code& error);

/// Makes a folder that only this user may enter, and returns its path: `stem` followed by random characters.
std::filesystem::path make_private_folder(const std::filesystem::path& stem, std::error_code& error);

}  // namespace meshgraft::platform
