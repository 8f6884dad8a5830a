#include "weld.h"

#include <algorithm>
#include <limits>
#include <numeric>

#include "coincident.h"

namespace meshgraft {

namespace {

bool is_vertex(Index v, Index count) { return v >= 0 && v < count; }

// Returns whether a vertex attribute becomes a corner attribute. Names are unique within a domain, so it
// stays per vertex if a corner attribute has the same name.
bool moves_to_corners(const Mesh& mesh, const Attribute& attribute) {
  return attribute.domain == Domain::vertex && mesh.find_attribute(Domain::corner, attribute.name) == nullptr;
}

Attribute on_corners(const Mesh& mesh, const Attribute& attribute) {
  Attribute result = attribute;
  result.domain = Domain::corner;
  const auto count = static_cast<std::size_t>(attribute.components);
  const std::vector<Index>& corners = mesh.faces.corners();
  result.values.assign(corners.size() * count, std::numeric_limits<double>::quiet_NaN());
  for (std::size_t c = 0; c < corners.size(); ++c)
    if (is_vertex(corners[c], mesh.vertex_count()))
      std::copy_n(attribute.values.data() + corners[c] * count, count, result.values.data() + c * count);
  return result;
}

void take_from_corners(const Faces& faces, const Attribute& from, Index vertex_count, Attribute& to) {
  const auto count = static_cast<std::size_t>(to.components);
  const std::vector<Index>& corners = faces.corners();
  for (std::size_t c = 0; c < corners.size(); ++c)
    if (is_vertex(corners[c], vertex_count))
      std::copy_n(from.values.data() + c * count, count, to.values.data() + corners[c] * count);
}

}  // namespace

Weld weld_at(const Mesh& mesh, std::span<const Index> vertices) {
  const std::vector<Index> classes = coincident_classes(mesh.positions, vertices);
  Weld weld;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (classes[k] == vertices[k]) continue;
    if (weld.empty()) {
      weld.representative.resize(mesh.vertex_count());
      std::iota(weld.representative.begin(), weld.representative.end(), 0);
    }
    weld.representative[vertices[k]] = classes[k];
    ++weld.copies;
  }
  return weld;
}

Mesh welded(const Mesh& mesh, const Weld& weld) {
  Mesh result;
  result.positions = mesh.positions;
  result.faces.reserve(mesh.face_count(), mesh.faces.corner_count());
  std::vector<Index> face;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    face.assign(mesh.faces[f].begin(), mesh.faces[f].end());
    for (Index& v : face)
      if (is_vertex(v, mesh.vertex_count())) v = weld.of(v);
    result.faces.push_back(face);
  }
  for (const Attribute& attribute : mesh.attributes) {
    const bool to_corners = moves_to_corners(mesh, attribute);
    result.attributes.push_back(to_corners ? on_corners(mesh, attribute) : attribute);
  }
  return result;
}

void unweld(const Mesh& moved, const Weld& weld, Mesh& mesh) {
  for (Index v = 0; v < mesh.vertex_count(); ++v) mesh.positions.row(v) = moved.positions.row(weld.of(v));
  for (std::size_t k = 0; k < mesh.attributes.size(); ++k) {
    Attribute& attribute = mesh.attributes[k];
    const Attribute& changed = moved.attributes[k];
    if (attribute.domain == changed.domain)
      attribute.values = changed.values;
    else
      take_from_corners(mesh.faces, changed, mesh.vertex_count(), attribute);
  }
}

}  // namespace meshgraft
