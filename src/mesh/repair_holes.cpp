// Repair of holes: boundary loops that are closed by triangles.

#include <algorithm>
#include <array>

#include <Eigen/Geometry>

#include <meshgraft/mesh/topology.h>

#include "face_defects.h"
#include "hole_triangulation.h"
#include "repair_surface.h"

namespace meshgraft {

namespace {

constexpr Index default_edges = 24;
constexpr double default_area_rel = 0.005;  // of the part: a larger opening is taken to be meant

// A loop with the half-edges along it, turned to run as the faces that are to close it.
struct Hole {
  std::vector<Index> vertices;
  std::vector<Index> outside;  // the half-edge of the surface from vertices[k+1] to vertices[k]
};

double fan_area(const Points& positions, const std::vector<Index>& loop) {
  Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
  for (const Index v : loop) centre += positions.row(v) / static_cast<double>(loop.size());
  double area = 0;
  for (std::size_t k = 0; k < loop.size(); ++k)
    area +=
        (positions.row(loop[k]) - centre).cross(positions.row(loop[(k + 1) % loop.size()]) - centre).norm() / 2;
  return area;
}

std::vector<Hole> find_holes(const RepairSurface& surface, std::optional<Index> most_edges) {
  const EdgeTable& table = surface.edges();
  const std::vector<Index>& corners = surface.faces().corners();
  const auto limit = static_cast<std::size_t>(most_edges.value_or(default_edges));
  std::vector<std::vector<Index>> loops = boundary_loops(surface.mesh());
  std::erase_if(loops, [&](const auto& loop) { return loop.size() > limit; });
  std::vector<Hole> holes;
  if (loops.empty()) return holes;

  std::vector<Index> leaving(surface.mesh().vertex_count(), -1);  // the boundary half-edge from each vertex
  for (Index c = 0; c < static_cast<Index>(corners.size()); ++c)
    if (table.next[c] >= 0 && table.is_boundary(c)) leaving[corners[c]] = c;
  const SurfaceParts parts = parts_of(surface);
  for (const auto& loop : loops) {
    Hole hole;
    const std::size_t n = loop.size();
    bool sound = true;
    for (std::size_t k = 0; k < n && sound; ++k) {
      const Index c = leaving[loop[k]];
      sound = c >= 0 && corners[table.next[c]] == loop[(k + 1) % n];
      hole.vertices.push_back(loop[n - 1 - k]);
    }
    if (!sound) continue;
    for (std::size_t k = 0; k < n; ++k) hole.outside.push_back(leaving[hole.vertices[(k + 1) % n]]);
    const Index part = parts.of_face[surface.face_of(hole.outside[0])];
    if (static_cast<std::size_t>(parts.faces[part]) < n / 2 + 1 && parts.faces[part] < 2)
      continue;  // a lone face
    if (!most_edges && fan_area(surface.positions(), loop) > default_area_rel * parts.area[part]) continue;
    holes.push_back(std::move(hole));
  }
  return holes;
}

// Whether a triangulation has an edge, not of the loop, that the surface has already.
bool repeats_an_edge(const RepairSurface& surface, const Hole& hole,
                     const std::vector<std::array<Index, 3>>& triangles) {
  const auto n = static_cast<Index>(hole.vertices.size());
  const auto& ends = surface.edges().ends;
  for (const auto& t : triangles) {
    for (int k = 0; k < 3; ++k) {
      const Index i = t[k], j = t[(k + 1) % 3];
      if ((i + 1) % n == j || (j + 1) % n == i) continue;
      const auto [low, high] = std::minmax(hole.vertices[i], hole.vertices[j]);
      if (std::binary_search(ends.begin(), ends.end(), std::array{low, high})) return true;
    }
  }
  return false;
}

std::vector<std::array<Index, 3>> cover(const RepairSurface& surface, const Hole& hole) {
  if (hole.vertices.size() == 3) return {{0, 1, 2}};
  const auto n = static_cast<Eigen::Index>(hole.vertices.size());
  const EdgeTable& table = surface.edges();
  Points polyline(n, 3), beyond(n, 3);
  for (Eigen::Index k = 0; k < n; ++k) {
    polyline.row(k) = surface.positions().row(hole.vertices[k]);
    beyond.row(k) = surface.positions().row(surface.faces().corners()[table.previous[hole.outside[k]]]);
  }
  auto triangles = triangulate_hole(polyline, beyond);
  if (triangles.size() != static_cast<std::size_t>(n - 2)) triangles.clear();
  return triangles;
}

}  // namespace

namespace {

// Corners of new faces: those of the loop by their place in it, its length for the new vertex in the middle.
using Cover = std::vector<std::array<Index, 3>>;

// Faces without area would be taken out again.
bool have_area(const RepairSurface& surface, const Hole& hole, const Cover& triangles,
               const Eigen::RowVector3d& middle) {
  const auto n = static_cast<Index>(hole.vertices.size());
  Points corners(3, 3);
  return std::none_of(triangles.begin(), triangles.end(), [&](const std::array<Index, 3>& t) {
    for (int k = 0; k < 3; ++k)
      corners.row(k) = t[k] < n ? Eigen::RowVector3d(surface.positions().row(hole.vertices[t[k]])) : middle;
    return has_no_area(std::array<Index, 3>{0, 1, 2}, corners);
  });
}

Eigen::RowVector3d middle_of(const RepairSurface& surface, const Hole& hole) {
  Eigen::RowVector3d middle = Eigen::RowVector3d::Zero();
  for (const Index v : hole.vertices)
    middle += surface.positions().row(v) / static_cast<double>(hole.vertices.size());
  return middle;
}

// Triangles between the loop's vertices, or (no edge of which can be there already) about a new one in its
// middle.
Cover cover_of(const RepairSurface& surface, const Hole& hole) {
  const auto n = static_cast<Index>(hole.vertices.size());
  const auto beside = [&](Index k) { return surface.face_of(hole.outside[k]); };
  if (n == 3 && beside(0) == beside(1) && beside(1) == beside(2)) return {};  // the other side of a lone face
  const Eigen::RowVector3d middle = middle_of(surface, hole);
  Cover triangles = cover(surface, hole);
  if (triangles.empty()) return {};
  if (!repeats_an_edge(surface, hole, triangles) && have_area(surface, hole, triangles, middle))
    return triangles;
  triangles.clear();
  for (Index k = 0; k < n; ++k) triangles.push_back({k, (k + 1) % n, n});
  return have_area(surface, hole, triangles, middle) ? triangles : Cover{};
}

// Adds the faces; their attributes continue those of the faces beside them.
void add_cover(const RepairSurface& surface, const Hole& hole, const Cover& triangles, RepairFaces& filled,
               std::vector<NewVertex>& added) {
  const auto n = static_cast<Index>(hole.vertices.size());
  const RepairFaces& traced = surface.traced();
  const auto value_at = [&](Index k) { return traced.corner[surface.edges().next[hole.outside[k]]]; };
  std::vector<Index> vertices = hole.vertices;
  std::vector<Between> values;
  for (Index k = 0; k < n; ++k) values.push_back(value_at(k));
  if (triangles.front()[2] == n) {
    vertices.push_back(surface.mesh().vertex_count() + static_cast<Index>(added.size()));
    values.push_back({values[0].from, values[n / 2].from, 0.5});
    added.push_back({middle_of(surface, hole), -1, hole.vertices[0], hole.vertices[n / 2]});
  }
  const Index origin = traced.origin[surface.face_of(hole.outside[0])];
  for (const auto& t : triangles)
    filled.add(std::array{vertices[t[0]], vertices[t[1]], vertices[t[2]]},
               std::array{values[t[0]], values[t[1]], values[t[2]]}, origin, true);
}

}  // namespace

bool fill_holes(RepairSurface& surface, std::optional<Index> most_edges) {
  RepairFaces filled = surface.traced();
  std::vector<NewVertex> added;
  std::vector<Index> given;
  Index count = 0, left = 0;
  for (const Hole& hole : find_holes(surface, most_edges)) {
    surface.context().throw_if_stopped();
    const Cover triangles = cover_of(surface, hole);
    if (triangles.empty()) {
      ++left;
      continue;
    }
    add_cover(surface, hole, triangles, filled, added);
    ++count;
    for (const Index v : hole.vertices)
      if (surface.vertex_origin(v) >= 0) given.push_back(surface.vertex_origin(v));
  }
  if (left > 0)
    surface.note(std::to_string(left) + (left == 1 ? " hole was" : " holes were") + " not closed: " +
                 (can_fill_holes() ? "no triangles fit."
                                   : "this build closes holes of three edges alone (it is without CGAL)."));
  if (count == 0) return false;
  surface.report("filled-hole", Domain::vertex, std::move(given), count,
                 "hole was closed (the vertices around it are named)",
                 "holes were closed (the vertices around them are named)");
  surface.add_vertices(added);
  surface.replace_faces(std::move(filled));
  return true;
}

}  // namespace meshgraft
