#pragma once

#include <filesystem>
#include <string>

#include "mesh_writer.h"
#include "stored_mesh.h"

namespace meshgraft::distributed {

/// The name of the index in the folder of a mesh in chunks.
constexpr const char* chunk_index_name = "mesh.json";

/// Returns the text of the index. Throws Error(io).
std::string read_chunk_index(const std::filesystem::path& folder);

/// Finds the records of a mesh in chunks. Throws Error(input) for an index that is not what docs/cluster.md
/// says.
StoredMesh parse_chunk_index(const std::string& text, const std::filesystem::path& folder);

/// Throws Error(io) if a file of records cannot be opened, and Error(input) if its size is not that of its
/// records.
void require_chunks(const StoredMesh& mesh);

/// Creates the index and the files of records, still empty, on one rank. Throws Error(io).
void create_chunks(MeshWriter& writer, const StoredMesh& mesh, const std::string& index);

/// Returns the index of little-endian records.
std::string chunk_index_text(const StoredMesh& mesh);

}  // namespace meshgraft::distributed
