#pragma once

#include <filesystem>
#include <memory>
#include <stop_token>
#include <string>
#include <string_view>
#include <system_error>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>

#include "core/memory_budget.h"
#include "io/facts.h"

namespace meshgraft {

/// Writes `content` to `path` so that a reader sees either the old file or the whole new one (a temporary
/// file beside it, flushed, then renamed). Pipes and devices are written to directly. Throws Error(io), and
/// Error(cancelled) if a stop is requested meanwhile, leaving no temporary file behind.
void write_file_atomically(const std::filesystem::path& path, std::string_view content,
                           const Context& context = {});

/// Follows the symbolic links of a path to their end, whether or not a file exists there.
std::filesystem::path follow_links(std::filesystem::path path);

/// Returns a whole file as bytes, as many as it had when it was opened. Pipes, devices and sockets are refused,
/// because they may never end. Charges the bytes to the budget before it takes memory. Throws Error(io):
/// io.file_not_found, io.is_folder, io.not_a_file, io.no_permission, …, and Error(memory).
std::string read_file(const std::filesystem::path& path, MemoryBudget& budget, const Context& context = {});
/// Reads a file with the default budget of a Context.
std::string read_file(const std::filesystem::path& path);

}  // namespace meshgraft

namespace meshgraft::io {

/// Returns the error of a failed system call: `action` is what failed.
Error file_error(const std::filesystem::path& path, facts::io::Action action, const std::error_code& error);

/// The behaviour of a write if `path` exists already.
enum class Existing { replace, refuse };

/// A file that is written beside its target, flushed to the disk, and appears by a rename. Several files can
/// thus appear only once all of them have been written. Without `appear`, the file is removed.
class PendingFile {
 public:
  /// Writes the temporary file. Throws Error(io), and Error(cancelled) if a stop is requested meanwhile.
  /// `content` must outlive this object.
  PendingFile(const std::filesystem::path& path, std::string_view content, Existing existing,
              const std::stop_token& stop = {});
  PendingFile(PendingFile&&) noexcept;
  ~PendingFile();

  /// Renames the file to the target, or links it for `refuse`. A replaced file keeps its permissions, and a
  /// symbolic link keeps its target. Pipes and devices are written to at this point. Throws Error(io), and
  /// Error(cancelled) if a stop is requested before a pipe or a device has taken all.
  void appear(const std::stop_token& stop = {});

 private:
  class TemporaryFile;
  std::filesystem::path path_, target_;
  Existing existing_;
  std::unique_ptr<TemporaryFile> temporary_;  // null for pipes and devices
  std::string_view for_device_;
};

}  // namespace meshgraft::io
