#pragma once

#include <filesystem>
#include <vector>

namespace meshgraft::test {

/// Returns the mesh files (OBJ, OFF, PLY, STL) in a folder and below, ascending by path; none without the
/// folder.
std::vector<std::filesystem::path> mesh_files(const std::filesystem::path& folder);

}  // namespace meshgraft::test
