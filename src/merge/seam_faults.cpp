#include "seam_faults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/topology.h>

#include "mesh/area_vector.h"
#include "mesh/box_diagonal.h"
#include "mesh/edge_table.h"

namespace meshgraft {

namespace {

/// Returns, per vertex, whether it is within three rings of a strip, which is where bands are by default.
Flags near_seam(const JoinedMesh& joined) {
  constexpr int rings = 3;
  Flags near(joined.mesh.vertex_count(), 0);
  for (const Index v : make_seam_patch(joined.mesh, joined.layout, rings).vertex) near[v] = 1;
  return near;
}

/// Returns the vertices' positions at rest, the source's moved away from the target.
Points rest_apart(const JoinedMesh& joined) {
  Points rest = joined.rest;
  const Eigen::Index source = rest.rows() - joined.layout.target_vertices;
  if (source == 0 || joined.layout.target_vertices == 0) return rest;
  double lowest = std::numeric_limits<double>::infinity(), highest = -lowest;
  for (Eigen::Index v = 0; v < rest.rows(); ++v) {
    const double x = rest(v, 0);
    if (!std::isfinite(x)) continue;
    if (v < joined.layout.target_vertices) highest = std::max(highest, x);
    if (v >= joined.layout.target_vertices) lowest = std::min(lowest, x);
  }
  const double size = std::max(std::abs(highest), std::abs(lowest));
  if (std::isfinite(size)) rest.col(0).tail(source).array() += highest - lowest + size;
  return rest;
}

/// Returns whether two faces that share an edge are folded onto one another.
bool folded(const Eigen::Vector3d& area, const Eigen::Vector3d& other) {
  static const double cosine = std::cos(160 * std::numbers::pi / 180);  // chosen: 20° from lying on one another
  return area.dot(other) < cosine * area.norm() * other.norm();
}

Index count_folded_edges(const JoinedMesh& joined, const Flags& near) {
  // Only faces with at least two vertices near the seam can have an edge there.
  Faces faces;
  for (Index f = 0; f < joined.mesh.face_count(); ++f) {
    const auto face = joined.mesh.faces[f];
    if (std::count_if(face.begin(), face.end(), [&](Index v) { return near[v] != 0; }) >= 2)
      faces.push_back(face);
  }
  const EdgeTable table(joined.mesh.vertex_count(), faces);
  std::vector<Index> face_of_corner;
  for (Index f = 0; f < faces.size(); ++f) face_of_corner.insert(face_of_corner.end(), faces[f].size(), f);
  Index count = 0;
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto& sides = table.half_edges[e];
    if (sides.size() != 2 || near[table.ends[e][0]] == 0 || near[table.ends[e][1]] == 0) continue;
    const auto one = faces[face_of_corner[sides[0]]], other = faces[face_of_corner[sides[1]]];
    if (!folded(area_vector(one, joined.mesh.positions), area_vector(other, joined.mesh.positions))) continue;
    // A comparison with a vertex that is not finite is false, so that a new face never was folded.
    if (!folded(area_vector(one, joined.rest), area_vector(other, joined.rest))) ++count;
  }
  return count;
}

/// Returns the triangles whose bounding boxes meet that of the triangles near the seam.
Triangles around_seam(const Points& points, const Triangles& all, const Flags& near) {
  Eigen::AlignedBox3d box;
  for (Eigen::Index t = 0; t < all.rows(); ++t)
    if (near[all(t, 0)] != 0 && near[all(t, 1)] != 0 && near[all(t, 2)] != 0)
      for (int c = 0; c < 3; ++c) box.extend(points.row(all(t, c)).transpose());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index t = 0; t < all.rows(); ++t) {
    Eigen::AlignedBox3d own;
    for (int c = 0; c < 3; ++c) own.extend(points.row(all(t, c)).transpose());
    if (box.intersects(own)) kept.push_back(t);
  }
  return all(kept, Eigen::all);
}

}  // namespace

SeamFaults find_seam_faults(const JoinedMesh& joined, const Context& context) {
  const Flags near = near_seam(joined);
  std::vector<Index> vertices;
  for (Index v = 0; v < joined.mesh.vertex_count(); ++v)
    if (near[v] != 0) vertices.push_back(v);
  const Points& points = joined.mesh.positions;
  const Triangles triangles =
      around_seam(points, triangulate(joined.mesh, {.skip_out_of_range = true}).triangles, near);
  const auto is_near = [&](Index t) {
    return near[triangles(t, 0)] != 0 && near[triangles(t, 1)] != 0 && near[triangles(t, 2)] != 0;
  };
  SeamFaults faults;
  faults.folded_edges = count_folded_edges(joined, near);
  for (const auto& [a, b] :
       new_self_intersections({rest_apart(joined), points, triangles, vertices}, context)) {
    if (is_near(a) && is_near(b))
      ++faults.crossings;
    else if (is_near(a) || is_near(b))
      ++faults.far_crossings;
  }
  return faults;
}

}  // namespace meshgraft
