#include "closed_parts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "disjoint_sets.h"
#include "fans.h"

namespace meshgraft {

namespace {

struct Box {
  Eigen::RowVector3d low = Eigen::RowVector3d::Constant(std::numeric_limits<double>::infinity());
  Eigen::RowVector3d high = -low;
  void add(const Eigen::RowVector3d& point) {
    low = low.cwiseMin(point);
    high = high.cwiseMax(point);
  }
  bool contains(const Box& other) const {
    return (low.array() <= other.low.array()).all() && (other.high.array() <= high.array()).all();
  }
};

// One entry per part, at its smallest vertex.
struct Parts {
  std::vector<Index> part;
  std::vector<char> closed;
  std::vector<double> volume, area;
};

Parts measure(const Mesh& mesh, const EdgeTable& table) {
  const Index vertices = mesh.vertex_count();
  DisjointSets sets(vertices);
  for (const auto& ends : table.ends) sets.unite(ends[0], ends[1]);
  Parts parts;
  parts.part.resize(vertices);
  for (Index v = 0; v < vertices; ++v) parts.part[v] = sets.root(v);
  parts.closed.assign(vertices, 1);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (wound_alike(mesh, table, e) != true) parts.closed[parts.part[table.ends[e][0]]] = 0;
  parts.volume.assign(vertices, 0);
  parts.area.assign(vertices, 0);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    if (face.empty() || table.next[mesh.faces.first_corner(f)] < 0) continue;
    const Index part = parts.part[face[0]];
    const Eigen::RowVector3d origin = mesh.positions.row(part), a = mesh.positions.row(face[0]);
    for (std::size_t c = 2; c < face.size(); ++c) {
      const Eigen::RowVector3d normal =
          (mesh.positions.row(face[c - 1]) - a).cross(mesh.positions.row(face[c]) - a);
      parts.volume[part] += (a - origin).dot(normal) / 6;
      parts.area[part] += normal.norm() / 2;
    }
  }
  return parts;
}

// How many times the faces wind around the point (van Oosterom and Strackee, 1983).
double winding_number(const Mesh& mesh, const std::vector<Index>& faces, const Eigen::RowVector3d& point) {
  double solid_angle = 0;
  for (const Index f : faces) {
    const auto face = mesh.faces[f];
    const Eigen::RowVector3d a = mesh.positions.row(face[0]) - point;
    for (std::size_t k = 2; k < face.size(); ++k) {
      const Eigen::RowVector3d b = mesh.positions.row(face[k - 1]) - point;
      const Eigen::RowVector3d c = mesh.positions.row(face[k]) - point;
      const double la = a.norm(), lb = b.norm(), lc = c.norm();
      solid_angle +=
          2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
  }
  return solid_angle / (4 * std::numbers::pi);
}

}  // namespace

InwardParts inward_parts(const Mesh& mesh, const EdgeTable& table, const Context& context) {
  Parts parts = measure(mesh, table);
  constexpr double flat = 1e-9;  // × area^1.5: no volume to speak of
  std::vector<Index> closed, inward;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (parts.part[v] != v || !parts.closed[v] || !(parts.area[v] > 0)) continue;
    closed.push_back(v);
    if (parts.volume[v] < -flat * std::pow(parts.area[v], 1.5)) inward.push_back(v);
  }
  if (!inward.empty() && closed.size() > 1) {
    std::vector<Box> box(mesh.vertex_count());
    for (Index v = 0; v < mesh.vertex_count(); ++v) box[parts.part[v]].add(mesh.positions.row(v));
    std::vector<std::vector<Index>> faces(mesh.vertex_count());
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (const auto face = mesh.faces[f]; !face.empty() && table.next[mesh.faces.first_corner(f)] >= 0)
        faces[parts.part[face[0]]].push_back(f);
    std::erase_if(inward, [&](Index part) {
      context.throw_if_stopped();
      return std::any_of(closed.begin(), closed.end(), [&](Index other) {
        return other != part && box[other].contains(box[part]) &&
               std::abs(winding_number(mesh, faces[other], mesh.positions.row(part))) > 0.5;
      });
    });
  }
  return {std::move(parts.part), std::move(inward)};
}

}  // namespace meshgraft
