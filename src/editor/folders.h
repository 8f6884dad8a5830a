#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <meshgraft/script/edit_file.h>

namespace meshgraft::editor {

/// The folders whose files a page may read and write, with all that is below them. Links are followed first, so
/// none leads out.
class Folders {
 public:
  /// Throws Error(io) for a folder that does not exist.
  explicit Folders(const std::vector<std::filesystem::path>& folders);

  const std::vector<std::filesystem::path>& roots() const { return roots_; }

  /// Where `path` leads: without links, dots, and whatever else hides it. A relative one starts from the first
  /// folder. Throws Error(input) if that is in none of the folders.
  std::filesystem::path inside(const std::filesystem::path& path) const;

  /// A mesh that may be read: the file itself and all that it refers to are inside. Throws Error(input).
  std::filesystem::path mesh_to_read(const std::filesystem::path& path) const;

  /// A mesh that may be written, with the file that some formats put beside it. Throws Error(input), also for
  /// an extension that no format has.
  std::filesystem::path mesh_to_write(const std::filesystem::path& path) const;

  /// Throws Error(input) unless all that running the edit reads is inside.
  void require_inside(const EditFile& edit) const;

 private:
  std::vector<std::filesystem::path> roots_;
};

/// Copies a file into a folder, by its name, or with a number where another file has that. Returns the copy.
/// Throws std::filesystem::filesystem_error, and Error(io) where one of them cannot be read.
std::filesystem::path copy_into(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Whether the axis y stands upright in files of the kind: of those that do not say, what most of their makers
/// mean.
bool stands_on_y(const std::filesystem::path& file);

/// What an uploaded file was called: without what the server puts behind its name to make it the only one.
std::filesystem::path uploaded_as(const std::filesystem::path& upload);

}  // namespace meshgraft::editor
