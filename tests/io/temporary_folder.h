#pragma once

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include <meshgraft/io/mesh_io.h>

#include "io/file.h"

namespace meshgraft::test {

/// A temporary folder, removed on destruction.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string pattern = (std::filesystem::temp_directory_path() / "meshgraft-test-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a temporary folder");
    path_ = pattern;
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::permissions(path_, std::filesystem::perms::owner_all, ignored);
    std::filesystem::remove_all(path_, ignored);
  }

  const std::filesystem::path& path() const { return path_; }
  std::filesystem::path operator/(const char* name) const { return path_ / name; }

  std::filesystem::path file(const char* name, std::string_view content) const {
    std::filesystem::remove(path_ / name);  // truncating a file makes some file systems flush it, slowly
    std::ofstream(path_ / name, std::ios::binary) << content;
    return path_ / name;
  }

  /// Writes a file of this name and content, and returns the mesh that is read from it.
  Mesh mesh(const char* name, std::string_view content) const { return read_mesh(file(name, content)); }

  /// Writes a mesh under this name, and returns the file's content.
  std::string written(const Mesh& mesh, const char* name) const {
    write_mesh(mesh, path_ / name);
    return read_file(path_ / name);
  }

  std::size_t entry_count() const {
    std::size_t count = 0;
    for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(path_)) ++count;
    return count;
  }

 private:
  std::filesystem::path path_;
};

}  // namespace meshgraft::test
