#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "communicator.h"
#include "local_mesh.h"
#include "mesh_writer.h"
#include "stored_mesh.h"

namespace meshgraft::distributed {

/// A mesh in a binary PLY file or in chunks that all ranks read and write together by MPI-IO. Each rank holds
/// an equal share of its vertices and of its faces, in the order of the records. Errors are thrown on all
/// ranks.
class MeshFile {
 public:
  /// Reads the header or the index. Throws what `open_stored_mesh` throws.
  MeshFile(const Communicator& comm, const std::filesystem::path& path);

  Number vertex_count() const { return stored_.vertices.count; }
  Number face_count() const { return stored_.faces.count; }
  bool in_chunks() const { return stored_.in_chunks; }
  /// Returns where the ranks' shares of the vertices start.
  const std::vector<Number>& vertex_starts() const { return vertex_starts_; }
  bool has_normals() const { return has_normals_; }

  /// Reads the positions, or the normals, of the own vertices.
  Points read_positions() const { return read(position_names); }
  Points read_normals() const { return read(normal_names); }
  /// Reads the own faces by their numbers. Faces with a repeated corner are left out. Throws Error(input) for a
  /// face that is no triangle and for a vertex that does not exist.
  std::vector<NumberedTriangle> read_triangles() const;

  /// The values of the own vertices before and after an edit. Without normals these are empty.
  struct Changes {
    const Points &positions_before, &positions_after;
    const Points &normals_before, &normals_after;
  };
  /// Writes the mesh with changed values under another name, in the same format. Bytes of values that did not
  /// change stay. The output appears as a whole or not at all. Throws Error(io).
  void write(const std::filesystem::path& output, const Changes& changes) const;

 private:
  using Names = std::array<const char*, 3>;
  static constexpr Names position_names = {"x", "y", "z"}, normal_names = {"nx", "ny", "nz"};

  Points read(const Names& names) const;
  void write_vertices(MeshWriter& writer, const Changes& changes) const;
  void copy_rest(MeshWriter& writer) const;

  const Communicator& comm_;
  StoredMesh stored_;
  bool has_normals_ = false;
  std::vector<Number> vertex_starts_, face_starts_;
};

}  // namespace meshgraft::distributed
