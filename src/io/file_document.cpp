#include "file_document.h"

#include <algorithm>
#include <bit>
#include <utility>

#include "mesh/join.h"

namespace meshgraft::io {

void FileDocument::remember_topology(const Mesh& mesh) { topology_ = topology_of(mesh); }

bool FileDocument::has_topology_of(const Mesh& mesh) const { return topology_ == topology_of(mesh); }

FileDocument::Topology FileDocument::topology_of(const Mesh& mesh) {
  Topology topology{mesh.vertex_count(), mesh.face_count(), mesh.faces.corner_count()};
  auto& [first, second] = topology.hash;
  const auto add = [&](Index number) {
    // Each step is invertible, so different states stay different under the same further numbers.
    first = (std::rotl(first, 23) ^ static_cast<std::uint32_t>(number)) * 0x9E3779B97F4A7C15u;
    second = (std::rotl(second, 29) + static_cast<std::uint32_t>(number)) * 0xD6E8FEB86659FD93u;
  };
  for (const Index end : mesh.faces.offsets()) add(end);
  for (const Index v : mesh.faces.corners()) add(v);
  return topology;
}

std::vector<const FileDocument*> documents_of(const Mesh& mesh) {
  std::vector<const FileDocument*> documents;
  const auto sources = sources_of(mesh);
  if (!sources) return documents;
  for (const JoinedSources::File& source : sources->files) {
    const auto* document = dynamic_cast<const FileDocument*>(source.document.get());
    if (document != nullptr && std::ranges::find(documents, document) == documents.end())
      documents.push_back(document);
  }
  return documents;
}

const FileDocument* origin_of(const Mesh& mesh) {
  const auto sources = sources_of(mesh);
  return sources ? dynamic_cast<const FileDocument*>(sources->origin.get()) : nullptr;
}

std::vector<Note> left_out_notes(const Mesh& mesh) {
  std::vector<Note> notes;
  for (const FileDocument* document : documents_of(mesh))
    for (Note& note : document->beside_the_mesh()) notes.push_back(std::move(note));
  return notes;
}

}  // namespace meshgraft::io
