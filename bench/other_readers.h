#pragma once

#include <cstddef>
#include <filesystem>

namespace meshgraft::bench {

/// Returns the number of faces that an established library reads from a file, or 0 where it cannot read it.
/// The library reads into a polygon soup or its own structure, with its default options.
std::size_t read_by_cgal(const std::filesystem::path& path);
std::size_t read_by_assimp(const std::filesystem::path& path);
std::size_t read_by_tinyobj(const std::filesystem::path& path);

}  // namespace meshgraft::bench
