#include "document.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/mesh/join.h>

#include "file.h"

namespace meshgraft::io {

void FileDocument::remember_topology(const Mesh& mesh) {
  faces.reserve(mesh.face_count(), mesh.faces.corner_count());
  prefer_huge_pages(faces.corners().data(), faces.corners().capacity());
  prefer_huge_pages(faces.offsets().data(), faces.offsets().capacity());
  faces = mesh.faces;
  vertex_count = mesh.vertex_count();
}

bool FileDocument::has_topology_of(const Mesh& mesh) const {
  return vertex_count == mesh.vertex_count() && faces == mesh.faces;
}

std::vector<const FileDocument*> documents_of(const Mesh& mesh) {
  std::vector<const FileDocument*> documents;
  const auto sources = sources_of(mesh);
  if (!sources) return documents;
  for (const JoinedSources::Part& part : sources->parts) {
    const auto* document = dynamic_cast<const FileDocument*>(part.source.get());
    if (document != nullptr && std::ranges::find(documents, document) == documents.end())
      documents.push_back(document);
  }
  return documents;
}

std::vector<std::string> left_out_notes(const Mesh& mesh) {
  std::vector<std::string> notes;
  for (const FileDocument* document : documents_of(mesh)) {
    const std::vector<std::string> lost = document->beside_the_mesh();
    if (!lost.empty())
      notes.push_back(fmt::format("of {} this is left out, for the faces are new: {}",
                                  document->path.filename().string(), fmt::join(lost, ", ")));
  }
  return notes;
}

}  // namespace meshgraft::io
