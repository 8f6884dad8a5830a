#include <meshgraft/mesh/weld.h>

#include <algorithm>
#include <array>
#include <limits>
#include <numeric>
#include <utility>

#include "edge_table.h"

namespace meshgraft {

namespace {

using Place = std::array<double, 3>;

// −0 and 0 are one place.
Place place_of(const Points& positions, Index v) {
  return {positions(v, 0) + 0.0, positions(v, 1) + 0.0, positions(v, 2) + 0.0};
}

// Finite vertices by their places, equal ones by number.
std::vector<Index> sorted_by_place(const Points& positions, std::vector<Index> vertices) {
  std::erase_if(vertices, [&](Index v) { return !positions.row(v).allFinite(); });
  std::vector<std::pair<Place, Index>> order;
  order.reserve(vertices.size());
  for (const Index v : vertices) order.emplace_back(place_of(positions, v), v);
  std::sort(order.begin(), order.end());
  std::transform(order.begin(), order.end(), vertices.begin(), [](const auto& entry) { return entry.second; });
  return vertices;
}

bool same_place(const Points& positions, Index a, Index b) {
  return (positions.row(a).array() == positions.row(b).array()).all();
}

// Of vertices sorted by place, those that are not alone at theirs.
std::vector<Index> crowded(const Points& positions, const std::vector<Index>& sorted) {
  std::vector<Index> vertices;
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    const bool with_last = k > 0 && same_place(positions, sorted[k - 1], sorted[k]);
    const bool with_next = k + 1 < sorted.size() && same_place(positions, sorted[k], sorted[k + 1]);
    if (with_last || with_next) vertices.push_back(sorted[k]);
  }
  return vertices;
}

std::vector<bool> boundary_vertices(const Mesh& mesh) {
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  std::vector<bool> boundary(static_cast<std::size_t>(mesh.vertex_count()), false);
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() != 1) continue;
    for (const Index v : table.ends[e]) boundary[v] = true;
  }
  return boundary;
}

bool is_vertex(Index v, Index count) { return v >= 0 && v < count; }

// Names are unique within a domain: where a corner attribute has the name already, the vertices keep theirs.
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
      std::copy_n(attribute.values.data() + static_cast<std::size_t>(corners[c]) * count, count,
                  result.values.data() + c * count);
  return result;
}

void take_from_corners(const Faces& faces, const Attribute& from, Index vertex_count, Attribute& to) {
  const auto count = static_cast<std::size_t>(to.components);
  const std::vector<Index>& corners = faces.corners();
  for (std::size_t c = 0; c < corners.size(); ++c)
    if (is_vertex(corners[c], vertex_count))
      std::copy_n(from.values.data() + c * count, count,
                  to.values.data() + static_cast<std::size_t>(corners[c]) * count);
}

}  // namespace

Weld coincident_boundary(const Mesh& mesh, const Context& context) {
  context.step("weld", 0);
  std::vector<Index> all(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(all.begin(), all.end(), 0);
  std::vector<Index> candidates = crowded(mesh.positions, sorted_by_place(mesh.positions, std::move(all)));
  if (candidates.empty()) return {};

  context.step("weld", 0.5);
  const std::vector<bool> boundary = boundary_vertices(mesh);
  std::erase_if(candidates, [&](Index v) { return !boundary[v]; });
  candidates = crowded(mesh.positions, candidates);
  if (candidates.empty()) return {};

  Weld weld;
  weld.representative.resize(static_cast<std::size_t>(mesh.vertex_count()));
  std::iota(weld.representative.begin(), weld.representative.end(), 0);
  for (std::size_t k = 0; k < candidates.size(); ++k) {
    const bool is_first = k == 0 || !same_place(mesh.positions, candidates[k - 1], candidates[k]);
    if (is_first)
      ++weld.places;
    else
      weld.representative[candidates[k]] = weld.representative[candidates[k - 1]];
  }
  weld.copies = static_cast<Index>(candidates.size()) - weld.places;
  context.step("weld", 1);
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
