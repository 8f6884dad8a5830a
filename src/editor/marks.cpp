#include "marks.h"

#include <algorithm>

#include <meshgraft/mesh/topology.h>

#include "binary_message.h"
#include "mesh/edge_table.h"

namespace meshgraft::editor {

namespace {

/// Collects marks of a mesh by its vertices.
class Marker {
 public:
  explicit Marker(const Mesh& mesh) : mesh_(mesh) {}

  void point(Index v) { add(marks_.points, {v}); }
  void line(Index from, Index to) { add(marks_.lines, {from, to}); }
  void triangle(const Triangles& triangles, Index t) {
    add(marks_.triangles, {triangles(t, 0), triangles(t, 1), triangles(t, 2)});
  }
  void outline(std::span<const Index> face) {
    for (std::size_t c = 0; c < face.size(); ++c) line(face[c], face[(c + 1) % face.size()]);
  }

  Marks take() { return std::move(marks_); }

 private:
  bool can_be_shown(Index v) const {
    return v >= 0 && v < mesh_.vertex_count() && mesh_.positions.row(v).allFinite();
  }
  void add(std::vector<Eigen::RowVector3d>& to, std::initializer_list<Index> vertices) const {
    if (!std::ranges::all_of(vertices, [&](Index v) { return can_be_shown(v); })) return;
    for (const Index v : vertices) to.emplace_back(mesh_.positions.row(v));
  }

  const Mesh& mesh_;
  Marks marks_;
};

Flags flags_of(const std::vector<Index>& indices, Index count) {
  Flags flags(static_cast<std::size_t>(count), 0);
  for (const Index index : indices) flags[index] = 1;
  return flags;
}

void mark_faces(Marker& marker, const Object& object, const std::vector<Index>& faces) {
  const Flags is_meant = flags_of(faces, object.mesh().face_count());
  for (Index t = 0; t < object.triangles.rows(); ++t)
    if (is_meant[object.triangle_faces[t]] != 0) marker.triangle(object.triangles, t);
  for (const Index f : faces) marker.outline(object.mesh().faces[f]);
}

// Returns whether two of these half-edges along one edge begin at the same vertex.
bool run_alike(const EdgeTable& table, const Faces& faces, std::span<const Index> half_edges) {
  return half_edges.size() == 2 && faces.corners()[half_edges[0]] == faces.corners()[half_edges[1]] &&
         table.next[half_edges[0]] >= 0;
}

void mark_edges(Marker& marker, const Mesh& mesh, FindingKind kind) {
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  for (Index e = 0; e < table.edge_count(); ++e) {
    const std::span<const Index> half_edges = table.half_edges[e];
    const bool is_meant = kind == FindingKind::non_manifold_edge ? half_edges.size() > 2
                                                                 : run_alike(table, mesh.faces, half_edges);
    if (is_meant) marker.line(table.ends[e][0], table.ends[e][1]);
  }
}

void mark_components(Marker& marker, const Object& object, const std::vector<Index>& seeds) {
  const std::vector<Index> component = connected_components(object.mesh());
  std::vector<Index> meant;
  for (const Index seed : seeds) meant.push_back(component[seed]);
  std::ranges::sort(meant);
  for (Index t = 0; t < object.triangles.rows(); ++t)
    if (std::ranges::binary_search(meant, component[object.triangles(t, 0)]))
      marker.triangle(object.triangles, t);
}

// Marks the corners of the vertices' faces that are not among them.
void mark_neighbours(Marker& marker, const Mesh& mesh, const std::vector<Index>& vertices) {
  const Flags is_meant = flags_of(vertices, mesh.vertex_count());
  const auto is_among = [&](Index v) { return v >= 0 && v < mesh.vertex_count() && is_meant[v] != 0; };
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    if (std::ranges::none_of(face, is_among)) continue;
    for (const Index v : face)
      if (!is_among(v)) marker.point(v);
  }
}

// Returns the triangles of pairs, each once.
std::vector<Index> triangles_in(const std::vector<TrianglePair>& pairs) {
  std::vector<Index> triangles;
  for (const TrianglePair& pair : pairs) triangles.insert(triangles.end(), pair.begin(), pair.end());
  std::ranges::sort(triangles);
  const auto repeated = std::ranges::unique(triangles);
  triangles.erase(repeated.begin(), repeated.end());
  return triangles;
}

std::vector<float> as_floats(const std::vector<Eigen::RowVector3d>& positions,
                             const Eigen::RowVector3d& offset) {
  std::vector<float> floats;
  floats.reserve(3 * positions.size());
  for (const Eigen::RowVector3d& position : positions)
    for (int k = 0; k < 3; ++k) floats.push_back(static_cast<float>(position[k] - offset[k]));
  return floats;
}

}  // namespace

Marks marks_of(const Object& object, const Finding& finding) {
  Marker marker(object.mesh());
  switch (finding.kind) {
    case FindingKind::non_finite:
    case FindingKind::outlying_vertex: mark_neighbours(marker, object.mesh(), finding.indices); break;
    case FindingKind::non_manifold_edge:
    case FindingKind::inconsistent_winding: mark_edges(marker, object.mesh(), finding.kind); break;
    case FindingKind::inward_facing_component: mark_components(marker, object, finding.indices); break;
    default:
      if (finding.domain == Domain::face)
        mark_faces(marker, object, finding.indices);
      else
        for (const Index v : finding.indices) marker.point(v);
  }
  return marker.take();
}

Marks marks_of(const Mesh& mesh, const PrintCheck& check, PrintFinding finding) {
  Marker marker(mesh);
  const auto mark_lines = [&](const std::vector<std::array<Index, 2>>& edges) {
    for (const auto& [from, to] : edges) marker.line(from, to);
  };
  const auto mark_triangles = [&](const std::vector<Index>& triangles) {
    for (const Index t : triangles) marker.triangle(check.surface.triangles, t);
  };
  switch (finding) {
    case PrintFinding::open_edges: mark_lines(check.open_edges); break;
    case PrintFinding::non_manifold_edges: mark_lines(check.non_manifold_edges); break;
    case PrintFinding::turned_edges: mark_lines(check.turned_edges); break;
    case PrintFinding::intersections: mark_triangles(triangles_in(check.intersections)); break;
    case PrintFinding::thin_walls: mark_triangles(check.thin); break;
    case PrintFinding::overhangs: mark_triangles(check.overhanging); break;
  }
  return marker.take();
}

std::vector<std::byte> marks_frame(const Object& object, const Marks& marks) {
  const Eigen::RowVector3d& c = object.offset;
  BinaryMessage message(MessageKind::marks, {{"mesh", object.id}, {"offset", {c.x(), c.y(), c.z()}}});
  message.add("points", as_floats(marks.points, c));
  message.add("lines", as_floats(marks.lines, c));
  message.add("triangles", as_floats(marks.triangles, c));
  return message.bytes();
}

}  // namespace meshgraft::editor
