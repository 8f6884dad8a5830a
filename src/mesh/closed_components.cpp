#include "closed_components.h"

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

// Measures of the connected components. Entries are indexed by the smallest vertex of the component, except
// `component`.
struct Components {
  std::vector<Index> component;
  Flags closed;
  std::vector<double> volume, area;
};

Components measure(const Mesh& mesh, const EdgeTable& table) {
  const Index vertices = mesh.vertex_count();
  DisjointSets sets(vertices);
  for (const auto& ends : table.ends) sets.unite(ends[0], ends[1]);
  Components components;
  components.component.resize(vertices);
  for (Index v = 0; v < vertices; ++v) components.component[v] = sets.root(v);
  components.closed.assign(vertices, 1);
  for (Index e = 0; e < table.edge_count(); ++e)
    if (consistently_oriented(mesh, table, e) != true)
      components.closed[components.component[table.ends[e][0]]] = 0;
  components.volume.assign(vertices, 0);
  components.area.assign(vertices, 0);
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    if (face.empty() || table.next[mesh.faces.first_corner(f)] < 0) continue;
    const Index component = components.component[face[0]];
    const Eigen::RowVector3d origin = mesh.positions.row(component), a = mesh.positions.row(face[0]);
    for (std::size_t c = 2; c < face.size(); ++c) {
      const Eigen::RowVector3d normal =
          (mesh.positions.row(face[c - 1]) - a).cross(mesh.positions.row(face[c]) - a);
      components.volume[component] += (a - origin).dot(normal) / 6;
      components.area[component] += normal.norm() / 2;
    }
  }
  return components;
}

// Returns the winding number of the faces around a point (van Oosterom and Strackee, 1983).
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

InwardComponents inward_components(const Mesh& mesh, const EdgeTable& table, const Context& context) {
  Components components = measure(mesh, table);
  constexpr double flat = 1e-9;  // × area^1.5: smaller volumes count as zero
  std::vector<Index> closed, inward;
  for (Index v = 0; v < mesh.vertex_count(); ++v) {
    if (components.component[v] != v || !components.closed[v] || !(components.area[v] > 0)) continue;
    closed.push_back(v);
    if (components.volume[v] < -flat * std::pow(components.area[v], 1.5)) inward.push_back(v);
  }
  if (!inward.empty() && closed.size() > 1) {
    std::vector<Box> box(mesh.vertex_count());
    for (Index v = 0; v < mesh.vertex_count(); ++v) box[components.component[v]].add(mesh.positions.row(v));
    std::vector<std::vector<Index>> faces(mesh.vertex_count());
    for (Index f = 0; f < mesh.face_count(); ++f)
      if (const auto face = mesh.faces[f]; !face.empty() && table.next[mesh.faces.first_corner(f)] >= 0)
        faces[components.component[face[0]]].push_back(f);
    std::erase_if(inward, [&](Index component) {
      context.throw_if_stopped();
      return std::any_of(closed.begin(), closed.end(), [&](Index other) {
        return other != component && box[other].contains(box[component]) &&
               std::abs(winding_number(mesh, faces[other], mesh.positions.row(component))) > 0.5;
      });
    });
  }
  return {std::move(components.component), std::move(inward)};
}

}  // namespace meshgraft
