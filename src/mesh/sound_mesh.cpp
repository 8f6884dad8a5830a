#include "sound_mesh.h"

#include <algorithm>

#include "face_defects.h"
#include "mesh/facts.h"
#include "traced_faces.h"

namespace meshgraft {

namespace {

bool is_refused(const Diagnostics& diagnostics) {
  return std::ranges::any_of(diagnostics.findings,
                             [](const Finding& finding) { return finding.severity == Severity::refused; });
}

bool has_usable_corners(const Mesh& mesh, Index face) {
  return in_range(mesh, face) &&
         std::ranges::all_of(mesh.faces[face], [&](Index v) { return mesh.positions.row(v).allFinite(); });
}

}  // namespace

SoundMesh::SoundMesh(const Mesh& mesh, const Diagnostics& diagnostics, const std::string& name)
    : given_(mesh), diagnostics_(diagnostics), name_(name) {
  if (!is_refused(diagnostics)) return;
  TracedFaces kept;
  std::vector<EdgePoint> corners;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    if (!has_usable_corners(mesh, f)) {
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
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (mesh.positions.row(v).allFinite()) continue;
    non_finite_.push_back(v);
    sound.positions.row(v) = mesh.positions.row(kept.faces[0][0]);
  }
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
  for (const Index v : non_finite_)
    if (const Index now = vertex.new_index[v]; now >= 0) result.positions.row(now) = given_.positions.row(v);
}

}  // namespace meshgraft
