#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "stored_mesh.h"

namespace meshgraft::distributed {

/// Returns the beginning of a PLY file with its header, and sets the size of the file. Throws Error(io).
std::string read_ply_beginning(const std::filesystem::path& path, std::uint64_t& file_bytes);

/// Finds the records of a PLY file. Throws Error(input) as `open_stored_mesh` says.
StoredMesh parse_ply_beginning(const std::string& beginning, const std::filesystem::path& path,
                               std::uint64_t file_bytes);

/// Returns the header of the little-endian PLY file with these records.
std::string ply_header_text(const StoredMesh& mesh);

}  // namespace meshgraft::distributed
