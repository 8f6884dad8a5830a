#pragma once

#include <filesystem>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/script/edit_file.h>

namespace meshgraft::editor {

/// The folders whose files, at any depth, a page may read and write. Symbolic links are resolved first, so
/// that no link leads out of them. Safe to use from any thread.
class Folders {
 public:
  /// Throws Error(io) for a folder that does not exist.
  explicit Folders(const std::vector<std::filesystem::path>& folders);

  std::vector<std::filesystem::path> roots() const;

  /// Adds a folder by its full path, which may begin with `~`, and returns it without links and dots. Throws
  /// Error(input) for a relative path and Error(io) for a folder that does not exist or cannot be read.
  std::filesystem::path add(const std::filesystem::path& folder);

  /// Returns the file that `path` refers to, without links and dots. A relative path starts from the first
  /// folder. Throws Error(input) with the id editor.outside_folders if the file is in none of the folders.
  std::filesystem::path inside(const std::filesystem::path& path) const;

  /// Returns the path of a mesh that may be read: the file and all files that it refers to are inside. Throws
  /// Error(input).
  std::filesystem::path mesh_to_read(const std::filesystem::path& path) const;

  /// Returns the path of a mesh that may be written, together with the companion file of some formats. Throws
  /// Error(input), also for an extension of no known format.
  std::filesystem::path mesh_to_write(const std::filesystem::path& path) const;

  /// Throws Error(input) unless all files that the edit reads are inside.
  void require_inside(const EditFile& edit) const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::filesystem::path> roots_;
};

/// Throws Error(io) at `asked` unless `file` is a file.
void require_file(const std::filesystem::path& file, const std::filesystem::path& asked);

/// Copies a file into a folder under its name; a number is appended where a different file has that name.
/// Returns the copy. Throws std::filesystem::filesystem_error, and Error(io) where a file cannot be read.
std::filesystem::path copy_into(const std::filesystem::path& folder, const std::filesystem::path& file);

/// The name of the folder of uploads. Uploaded parts of a session lie in a folder with the second suffix.
inline constexpr std::string_view upload_folder_name = "uploads", kept_folder_suffix = ".parts";

/// Returns the original name of an uploaded file, without the suffix that the server appends to make it
/// unique.
std::filesystem::path uploaded_as(const std::filesystem::path& upload);

/// Returns the error with the original names of uploaded files in its location, fields and notes, in place of
/// the paths where they are kept.
Error with_upload_names(const Error& error);

}  // namespace meshgraft::editor
