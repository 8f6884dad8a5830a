#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "communicator.h"
#include "record_table.h"

namespace meshgraft::distributed {

/// Tells where the records of a mesh are: in a binary PLY file, or in chunks, the files of a folder with an
/// index.
struct StoredMesh {
  std::filesystem::path path;
  bool in_chunks = false;
  RecordTable vertices, faces;
  std::vector<std::string> comments;
  /// Elements of a PLY file that have records and are neither vertices nor faces.
  std::vector<std::string> other_elements;
  std::uint64_t bytes = 0;  ///< of a PLY file
  std::string index;        ///< the text of the index of chunks

  /// Returns the corners of the faces, which `open_stored_mesh` has found.
  const RecordField& corners() const { return *faces.find(corners_name); }
  std::string corners_name = "vertex_indices";
};

/// Returns whether a name is that of a mesh in chunks, a folder: it ends in ".chunks".
bool names_chunks(const std::filesystem::path& path);

/// Reads the header or the index on the first rank, and returns it on all ranks. Throws Error(io) if a file
/// cannot be read; Error(input) for a PLY file with text, with records of different sizes before its last face,
/// or that ends early, for an index that is not what docs/cluster.md says, for files that do not fit it, and
/// for a mesh without coordinates or triangles.
StoredMesh open_stored_mesh(const Communicator& comm, const std::filesystem::path& path);

}  // namespace meshgraft::distributed
