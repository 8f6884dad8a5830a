#pragma once

#include <filesystem>
#include <memory>
#include <string_view>

namespace meshgraft::io {

/// What `write_file` does where `path` exists already.
enum class Existing { replace, refuse };

/// A file that is written beside its target, flushed to the disk, and has only to be renamed to appear: so
/// several files appear when all of them could be written. Goes without a trace unless it does.
class PendingFile {
 public:
  /// Throws Error(io). `content` must outlive it.
  PendingFile(const std::filesystem::path& path, std::string_view content, Existing existing);
  PendingFile(PendingFile&&) noexcept;
  ~PendingFile();

  /// Renames (or links, for `refuse`) it to the target. A replaced file keeps its permissions, a symbolic link
  /// keeps pointing where it did; pipes and devices are written to now. Throws Error(io).
  void appear();

 private:
  class TemporaryFile;
  std::filesystem::path path_, target_;
  Existing existing_;
  std::unique_ptr<TemporaryFile> temporary_;  // null for pipes and devices
  std::string_view for_device_;
};

/// Writes `content` to `path` so that a reader sees either the old file or the whole new one. Throws Error(io)
/// and leaves nothing behind.
void write_file(const std::filesystem::path& path, std::string_view content, Existing existing);

}  // namespace meshgraft::io
