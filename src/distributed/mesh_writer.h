#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string_view>

#include "communicator.h"
#include "record_table.h"
#include "shared_file.h"

namespace meshgraft::distributed {

/// Writes a PLY file, or the files of a mesh in chunks, which appears as a whole or not at all: it is written
/// under another name, which changes at the end. Without `appear`, it is removed. Throws Error(io).
class MeshWriter {
 public:
  /// Begins to write, on all ranks together. `output` is a folder for a mesh in chunks.
  MeshWriter(const Communicator& comm, std::filesystem::path output, bool in_chunks);
  ~MeshWriter();
  MeshWriter(const MeshWriter&) = delete;
  MeshWriter& operator=(const MeshWriter&) = delete;

  /// Creates a file of the folder, on one rank, before any rank writes into it.
  void create(const std::filesystem::path& name) const;
  /// Writes bytes on this rank alone. `name` is that of the file in the folder; a PLY file needs none. A mesh
  /// in chunks is written fastest file by file.
  void write(const std::filesystem::path& name, std::uint64_t at, const char* bytes, std::uint64_t size);
  /// Writes records `first` to `first + count` of a table. The names of its files are those in the folder.
  void write(const RecordTable& table, Number first, Number count, const char* bytes);
  /// Ends writing, on all ranks together: the mesh gets its name.
  void appear();

 private:
  void close_chunk();

  const Communicator& comm_;
  std::filesystem::path output_, pending_;
  bool in_chunks_;
  std::filesystem::path open_name_;  ///< of the open file in the folder
  std::optional<SharedFile> file_;   ///< the PLY file on all ranks, or this rank's open file in the folder
};

}  // namespace meshgraft::distributed
