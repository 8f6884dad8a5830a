#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "communicator.h"
#include "io/ply/document.h"
#include "linalg/sparse.h"
#include "local_mesh.h"

namespace meshgraft::distributed {

/// The records of an element of a binary PLY file, which all have the same size.
struct RecordRange {
  std::uint64_t begin = 0;  ///< byte of the first record
  std::uint64_t size = 0;   ///< bytes of a record
  Number count = 0;
  std::uint64_t end() const { return begin + size * static_cast<std::uint64_t>(count); }
};

/// Some properties of the vertices, in the order of the columns that their values have.
struct VertexProperties {
  std::vector<std::uint64_t> offset;  ///< bytes from the beginning of a record
  std::vector<ScalarType> type;
};

/// A binary PLY file of triangles that all ranks read and write together by MPI-IO. Each rank holds an equal
/// share of its vertices and of its faces, in the order of the file. Errors are thrown on all ranks.
class PlyFile {
 public:
  /// Reads the header. Throws Error(io) if the file cannot be read, and Error(input) for a file that is not
  /// binary PLY, that has records of different sizes before its last face, or faces other than triangles, and
  /// for one that ends early.
  PlyFile(const Communicator& comm, std::filesystem::path path);

  Number vertex_count() const { return vertices_.count; }
  Number face_count() const { return faces_.count; }
  /// Returns where the ranks' shares of the vertices start.
  const std::vector<Number>& vertex_starts() const { return vertex_starts_; }
  bool has_normals() const { return normals_.has_value(); }

  /// Reads the positions, or the normals, of the own vertices.
  Points read_positions() const { return read(positions_); }
  Points read_normals() const { return read(*normals_); }
  /// Reads the own faces by their numbers. Faces with a repeated corner are left out. Throws Error(input) for a
  /// face that is no triangle and for a vertex that does not exist.
  std::vector<NumberedTriangle> read_triangles() const;

  /// The values of the own vertices before and after an edit. Without normals these are empty.
  struct Changes {
    const Points &positions_before, &positions_after;
    const Points &normals_before, &normals_after;
  };
  /// Writes the file with changed values under another name. Bytes of values that did not change stay. The
  /// output appears as a whole or not at all. Throws Error(io).
  void write(const std::filesystem::path& output, const Changes& changes) const;

 private:
  void read_header(const std::string& beginning, std::uint64_t file_bytes);
  Points read(const VertexProperties& properties) const;
  template <class Body>
  void for_each_block(const RecordRange& range, Number first, Number end, const Body& body) const;

  const Communicator& comm_;
  std::filesystem::path path_;
  std::uint64_t bytes_ = 0;
  bool swap_ = false;
  RecordRange vertices_, faces_;
  VertexProperties positions_;
  std::optional<VertexProperties> normals_;
  std::uint64_t corners_offset_ = 0;  ///< of the list's length, from the beginning of a face's record
  ScalarType count_type_ = ScalarType::uint8, corner_type_ = ScalarType::int32;
  std::vector<Number> vertex_starts_, face_starts_;
};

}  // namespace meshgraft::distributed
