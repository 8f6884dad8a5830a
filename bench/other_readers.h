#pragma once

#include <cstddef>
#include <filesystem>

namespace meshgraft::bench {

/// The number of faces that an established library reads from a file, into a polygon soup or its own structure,
/// with its default options. 0 where it cannot.
std::size_t read_by_cgal(const std::filesystem::path& path);
std::size_t read_by_assimp(const std::filesystem::path& path);
std::size_t read_by_tinyobj(const std::filesystem::path& path);

}  // namespace meshgraft::bench
