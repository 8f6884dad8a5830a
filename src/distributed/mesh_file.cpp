#include "mesh_file.h"

#include <algorithm>
#include <cstdint>
#include <utility>

#include "chunk_index.h"
#include "io/binary_value.h"

namespace meshgraft::distributed {

namespace {

/// Bytes of a file that an edit does not change.
struct UnchangedBytes {
  std::filesystem::path path;
  std::uint64_t begin, size;
};

/// Returns all bytes of the files of a mesh but those of the vertices' records.
std::vector<UnchangedBytes> find_unchanged(const StoredMesh& mesh) {
  std::vector<UnchangedBytes> ranges;
  if (mesh.in_chunks) {
    for (const RecordFile& file : mesh.faces.files)
      ranges.push_back({file.path, 0, mesh.faces.size * static_cast<std::uint64_t>(file.count)});
    return ranges;
  }
  const RecordFile& vertices = mesh.vertices.files.front();
  const std::uint64_t end = mesh.vertices.byte_of(vertices, vertices.end());
  return {{mesh.path, 0, vertices.begin}, {mesh.path, end, mesh.bytes - end}};
}

/// Returns the ranges as a table of single bytes.
RecordTable byte_table(const std::vector<UnchangedBytes>& ranges) {
  RecordTable table{.size = 1};
  for (const auto& [path, begin, size] : ranges) {
    table.files.push_back({path, begin, table.count, static_cast<Number>(size)});
    table.count += static_cast<Number>(size);
  }
  return table;
}

}  // namespace

MeshFile::MeshFile(const Communicator& comm, const std::filesystem::path& path)
    : comm_(comm), stored_(open_stored_mesh(comm, path)) {
  has_normals_ = std::ranges::all_of(normal_names, [&](const char* name) {
    const RecordField* field = stored_.vertices.find(name);
    return field != nullptr && field->length == nullptr && field->type->scalar.has_value();
  });
  vertex_starts_ = equal_shares(stored_.vertices.count, comm.size());
  face_starts_ = equal_shares(stored_.faces.count, comm.size());
}

Points MeshFile::read(const Names& names) const {
  const RecordTable& table = stored_.vertices;
  const Number first = vertex_starts_[comm_.rank()], end = vertex_starts_[comm_.rank() + 1];
  Points values(end - first, 3);
  comm_.together([&] {
    table.for_each_block(first, end, [&](const char* bytes, const RecordFile&, Number record, Number count) {
      for (std::size_t k = 0; k < names.size(); ++k) {
        const RecordField& field = *table.find(names[k]);
        io::load_binary_column({bytes + field.offset, table.size, *field.type->scalar, table.swap},
                               static_cast<std::size_t>(count), values.data() + 3 * (record - first) + k, 3);
      }
    });
  });
  return values;
}

std::vector<NumberedTriangle> MeshFile::read_triangles() const {
  const RecordTable& table = stored_.faces;
  const RecordField& field = stored_.corners();
  const Number first = face_starts_[comm_.rank()], end = face_starts_[comm_.rank() + 1];
  std::vector<NumberedTriangle> triangles;
  triangles.reserve(end - first);
  const auto read_block = [&](const char* bytes, const RecordFile& file, Number record, Number count) {
    for (Number face = record; face < record + count; ++face, bytes += table.size) {
      const auto corners = load_triangle(bytes, field, table.swap, stored_.vertices.count,
                                         [&] { return table.location(file, "face", face); });
      if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
      triangles.push_back({face, corners});
    }
  };
  comm_.together([&] { table.for_each_block(first, end, read_block); });
  return triangles;
}

void MeshFile::write_vertices(MeshWriter& writer, const Changes& changes) const {
  const RecordTable& table = stored_.vertices;
  const Number first = vertex_starts_[comm_.rank()], end = vertex_starts_[comm_.rank() + 1];
  table.for_each_block(first, end, [&](char* bytes, const RecordFile&, Number record, Number count) {
    const auto patch = [&](const Names& names, const Points& before, const Points& after) {
      for (std::size_t c = 0; c < names.size(); ++c) {
        const RecordField& field = *table.find(names[c]);
        const auto column = static_cast<Eigen::Index>(c);
        for (Number k = 0; k < count; ++k) {
          const double value = after(record - first + k, column);
          if (value == before(record - first + k, column)) continue;
          io::store_binary(bytes + table.size * static_cast<std::uint64_t>(k) + field.offset, value,
                           *field.type->scalar, table.swap);
        }
      }
    };
    patch(position_names, changes.positions_before, changes.positions_after);
    if (has_normals_) patch(normal_names, changes.normals_before, changes.normals_after);
    writer.write(table, record, count, bytes);
  });
}

void MeshFile::copy_rest(MeshWriter& writer) const {
  const RecordTable rest = byte_table(find_unchanged(stored_));
  const std::vector<Number> share = equal_shares(rest.count, comm_.size());
  rest.for_each_block(share[comm_.rank()], share[comm_.rank() + 1],
                      [&](const char* bytes, const RecordFile&, Number byte, Number count) {
                        writer.write(rest, byte, count, bytes);
                      });
}

void MeshFile::write(const std::filesystem::path& output, const Changes& changes) const {
  MeshWriter writer(comm_, output, stored_.in_chunks);
  if (stored_.in_chunks) {
    comm_.together([&] {
      if (comm_.rank() == 0) create_chunks(writer, stored_, stored_.index);
    });
  }
  comm_.together([&] {
    write_vertices(writer, changes);
    copy_rest(writer);
  });
  writer.appear();
}

}  // namespace meshgraft::distributed
