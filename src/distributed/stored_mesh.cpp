#include "stored_mesh.h"

#include <utility>

#include "chunk_index.h"
#include "core/facts.h"
#include "ply_header.h"

namespace meshgraft::distributed {

namespace {

/// Throws Error(input) unless vertices have coordinates, and faces their corners.
void require_geometry(const StoredMesh& mesh) {
  for (const char* name : {"x", "y", "z"}) {
    const RecordField* field = mesh.vertices.find(name);
    if (field == nullptr || field->length != nullptr)
      throw Error(facts::io::MissingProperty{.element = "vertex", .property = "x, y, z"}, mesh.path);
    if (!field->type->scalar)
      throw Error(facts::distributed::UnfitType{.property = name, .type = std::string(field->type->name)},
                  mesh.path);
  }
  if (mesh.faces.count == 0) throw Error(facts::core::NoFaces{}, mesh.path);
  if (const RecordType& type = *mesh.corners().type; !type.is_integer)
    throw Error(facts::distributed::UnfitType{.property = mesh.corners().name, .type = std::string(type.name)},
                mesh.path);
}

}  // namespace

bool names_chunks(const std::filesystem::path& path) {
  return (path.has_filename() ? path : path.parent_path()).extension() == ".chunks";
}

StoredMesh open_stored_mesh(const Communicator& comm, const std::filesystem::path& path) {
  const bool in_chunks = names_chunks(path);
  std::string text;
  std::uint64_t bytes = 0;
  comm.together([&] {
    if (comm.rank() == 0) text = in_chunks ? read_chunk_index(path) : read_ply_beginning(path, bytes);
  });
  text = comm.broadcast(std::move(text));
  bytes = static_cast<std::uint64_t>(comm.largest(static_cast<Number>(bytes)));
  StoredMesh mesh;
  comm.together([&] {
    mesh = in_chunks ? parse_chunk_index(text, path) : parse_ply_beginning(text, path, bytes);
    require_geometry(mesh);
    if (in_chunks && comm.rank() == 0) require_chunks(mesh);
  });
  return mesh;
}

}  // namespace meshgraft::distributed
