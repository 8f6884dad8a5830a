#include "seam_patch.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

#include <Eigen/Geometry>

#include "mesh/area_vector.h"
#include "mesh/edge_table.h"
#include "mesh/face_defects.h"

namespace meshgraft {

namespace {

// Returns the ring of each vertex, or 0 beyond the last one. The outermost vertices have the number `rings` +
// 1.
std::vector<int> count_rings(const Mesh& mesh, const SeamLayout& layout, int rings) {
  std::vector<int> ring(mesh.vertex_count(), 0);
  for (Index f = layout.target_faces + layout.source_faces; f < mesh.face_count(); ++f) {
    for (const Index v : mesh.faces[f]) ring[v] = 1;
  }
  for (int r = 1; r <= rings; ++r) {
    for (Index f = 0; f < mesh.face_count(); ++f) {
      const auto face = mesh.faces[f];
      if (!in_range(face, mesh.vertex_count())) continue;
      if (std::none_of(face.begin(), face.end(), [&](Index v) { return ring[v] == r; })) continue;
      for (const Index v : face) {
        if (ring[v] == 0) ring[v] = r + 1;
      }
    }
  }
  return ring;
}

}  // namespace

SeamPatch make_seam_patch(const Mesh& mesh, const SeamLayout& layout, int rings) {
  const std::vector<int> ring = count_rings(mesh, layout, rings);
  std::vector<Index> faces;
  std::vector<Index> local(ring.size(), -1);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    if (!in_range(face, mesh.vertex_count())) continue;
    if (std::any_of(face.begin(), face.end(), [&](Index v) { return ring[v] > 0 && ring[v] <= rings; })) {
      faces.push_back(f);
      for (const Index v : face) local[v] = 0;
    }
  }

  SeamPatch patch;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (local[v] < 0) continue;
    local[v] = static_cast<Index>(patch.vertex.size());
    patch.vertex.push_back(v);
    patch.ring.push_back(ring[v]);
    patch.of.push_back(layout.side_of_vertex(v));
  }
  Mesh part;
  part.positions.resize(static_cast<Eigen::Index>(patch.vertex.size()), 3);
  for (std::size_t k = 0; k < patch.vertex.size(); ++k) {
    part.positions.row(static_cast<Eigen::Index>(k)) = mesh.positions.row(patch.vertex[k]);
  }
  std::vector<Index> corners;
  for (const Index f : faces) {
    corners.clear();
    for (const Index v : mesh.faces[f]) corners.push_back(local[v]);
    part.faces.push_back(corners);
  }

  // The patch's outer boundary is marked, too. Only marked edges within the patch are boundary edges of the
  // whole mesh.
  const EdgeTable table(part.vertex_count(), part.faces);
  patch.on_border.assign(patch.vertex.size(), false);
  for (Index e = 0; e < table.edge_count(); ++e) {
    if (table.half_edges[e].size() != 1) continue;
    for (const Index v : table.ends[e]) patch.on_border[v] = true;
  }

  const Triangulation triangulation = triangulate(part);
  patch.points = part.positions;
  patch.triangles = triangulation.triangles;
  for (const Index f : triangulation.face) patch.side.push_back(layout.side_of_face(faces[f]));
  return patch;
}

std::vector<SeamEdge> inner_edges(const SeamPatch& patch) {
  const Mesh mesh = make_mesh(patch.points, patch.triangles);
  const EdgeTable table(mesh.vertex_count(), mesh.faces);
  std::vector<SeamEdge> edges;
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto along = table.half_edges[e];
    if (along.size() != 2) continue;
    SeamEdge edge{table.ends[e], {along[0] / 3, along[1] / 3}, 0};
    const Eigen::Vector3d a = area_vector(patch.triangles, edge.triangles[0], patch.points),
                          b = area_vector(patch.triangles, edge.triangles[1], patch.points);
    edge.dihedral_deg = std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / std::numbers::pi;
    edges.push_back(edge);
  }
  return edges;
}

}  // namespace meshgraft
