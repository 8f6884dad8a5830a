#pragma once

#include <mpi.h>

#include <cstdint>
#include <filesystem>

namespace meshgraft::distributed {

/// A conversion between a binary PLY file and a mesh in chunks, by the names of the files.
struct ConvertRequest {
  std::filesystem::path input, output;
  std::int64_t records_per_file = std::int64_t{1} << 24;  ///< at most so many, of chunks
  bool force = false;                                     ///< a PLY file may replace the input
};

/// Converts a mesh, on all ranks together and in constant memory. The bytes of all values stay, but for their
/// order in a big-endian file; vertex indices of 64 bits become `int` in a PLY file. Throws what
/// `open_stored_mesh` throws; Error(input) for a face that is no triangle, a vertex that does not exist, and
/// data for which the output has no place; Error(usage) for an output that would replace another mesh;
/// Error(io).
void convert_mesh(MPI_Comm comm, const ConvertRequest& request);

/// Throws Error(input) unless the name is that of a PLY file or of a mesh in chunks.
void require_mesh_name(const std::filesystem::path& output);

/// Throws unless an output can be written there, on the rank that calls it. Throws Error(usage) if it would
/// replace the input without `force`, or a mesh in chunks would replace anything; Error(io) without its folder,
/// and for what is no regular file.
void require_output(const std::filesystem::path& output, const std::filesystem::path& input, bool force);

}  // namespace meshgraft::distributed
