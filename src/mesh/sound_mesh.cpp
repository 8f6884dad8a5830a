#include "sound_mesh.h"

#include <algorithm>

#include "face_defects.h"
#include "mesh/facts.h"
#include "traced_faces.h"

namespace meshgraft {

namespace {

// Returns the vertices that the check refuses, ascending.
std::vector<Index> refused_vertices(const Diagnostics& diagnostics) {
  std::vector<Index> vertices;
  for (const Finding& finding : diagnostics.findings)
    if (finding.severity == Severity::refused && finding.domain == Domain::vertex)
      vertices.insert(vertices.end(), finding.indices.begin(), finding.indices.end());
  std::ranges::sort(vertices);
  return vertices;
}

}  // namespace

SoundMesh::SoundMesh(const Mesh& mesh, const Diagnostics& diagnostics, const std::string& name)
    : given_(mesh), diagnostics_(diagnostics), name_(name) {
  if (std::ranges::none_of(diagnostics.findings,
                           [](const Finding& finding) { return finding.severity == Severity::refused; }))
    return;
  refused_ = refused_vertices(diagnostics);
  Flags refused(mesh.vertex_count(), 0);
  for (const Index v : refused_) refused[v] = 1;
  const auto usable = [&](Index f) {
    return in_range(mesh, f) && std::ranges::none_of(mesh.faces[f], [&](Index v) { return refused[v] != 0; });
  };
  TracedFaces kept;
  std::vector<EdgePoint> corners;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!usable(f)) {
      faces_.push_back(f);
      continue;
    }
    corners.clear();
    for (Index c = mesh.faces.first_corner(f); c < mesh.faces.first_corner(f + 1); ++c)
      corners.push_back(same(c));
    kept.add(mesh.faces[f], corners, f);
  }
  if (kept.faces.size() == 0) require_sound(diagnostics, mesh, {.name = name});

  Mesh& sound = sound_.emplace();
  sound.source = mesh.source;
  sound.positions = mesh.positions;
  for (const Index v : refused_) sound.positions.row(v) = mesh.positions.row(kept.faces[0][0]);
  std::vector<EdgePoint> faces;
  for (const Index f : kept.face_origin) faces.push_back(same(f));
  for (const Attribute& attribute : mesh.attributes) {
    if (attribute.domain == Domain::vertex)
      sound.attributes.push_back(attribute);
    else
      sound.attributes.push_back(
          interpolate_attribute(attribute, attribute.domain == Domain::face ? faces : kept.corner_origin));
  }
  sound.faces = std::move(kept.faces);
}

std::optional<Note> SoundMesh::note() const {
  if (faces_.empty()) return {};
  return facts::mesh::FacesLeftOut{.mesh = name_, .count = faces_.size()};
}

void SoundMesh::require_beyond(std::span<const Index> reached) const {
  if (!sound_) return;
  Flags within(given_.vertex_count(), 0);
  for (const Index v : reached)
    if (is_vertex_of(given_, v)) within[v] = 1;  // a missing vertex is reported where it is used
  // A finding may name only the face's one vertex that is not reached, so all corners of the face count.
  std::vector<Index> touched;
  for (const Index f : faces_) {
    const auto face = given_.faces[f];
    if (std::ranges::any_of(face, [&](Index v) { return is_vertex_of(given_, v) && within[v]; }))
      touched.insert(touched.end(), face.begin(), face.end());
  }
  if (!touched.empty()) require_sound(diagnostics_, given_, {.vertices = touched, .name = name_});
}

Error SoundMesh::explained(const Error& error) const {
  const std::optional<Note> left_out = note();
  return left_out ? error.with(*left_out) : error;
}

void SoundMesh::put_back(const IndexMap& vertex, Mesh& result) const {
  for (const Index v : refused_)
    if (const Index now = vertex.new_index[v]; now >= 0) result.positions.row(now) = given_.positions.row(v);
}

}  // namespace meshgraft
