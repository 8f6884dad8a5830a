#include "support/mesh_files.h"

#include <algorithm>
#include <array>
#include <string>

namespace meshgraft::test {

std::vector<std::filesystem::path> mesh_files(const std::filesystem::path& folder) {
  constexpr std::array extensions{".obj", ".off", ".ply", ".stl"};
  std::vector<std::filesystem::path> files;
  if (!std::filesystem::is_directory(folder)) return files;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder))
    if (std::ranges::find(extensions, entry.path().extension().string()) != extensions.end())
      files.push_back(entry.path());
  std::sort(files.begin(), files.end());
  return files;
}

}  // namespace meshgraft::test
