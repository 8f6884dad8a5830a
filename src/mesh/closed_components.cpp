#include "closed_components.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/parallel.h"
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

// Sums of consecutive faces of one component.
struct FaceRun {
  Index component;
  double volume, area;
};

// Sums up blocks of a fixed size, so that the result does not depend on the number of threads.
Components measure(const Mesh& mesh, const SimpleSurface& surface, const Context& context) {
  Components components{surface.components, Flags(surface.components.size(), 1),
                        std::vector<double>(surface.components.size(), 0),
                        std::vector<double>(surface.components.size(), 0)};
  const std::vector<Index>& corners = mesh.faces.corners();
  for (const Index corner : surface.leaving) components.closed[surface.components[corners[corner]]] = 0;
  constexpr std::size_t block_size = 4096;
  const auto faces = static_cast<std::size_t>(mesh.face_count());
  std::vector<std::vector<FaceRun>> blocks((faces + block_size - 1) / block_size);
  const auto measure_block = [&](std::size_t block) {
    std::vector<FaceRun>& runs = blocks[block];
    for (std::size_t f = block * block_size; f < std::min(faces, (block + 1) * block_size); ++f) {
      const Index component = surface.components[corners[3 * f]];
      const Eigen::RowVector3d origin = mesh.positions.row(component), a = mesh.positions.row(corners[3 * f]);
      const Eigen::RowVector3d normal =
          (mesh.positions.row(corners[3 * f + 1]) - a).cross(mesh.positions.row(corners[3 * f + 2]) - a);
      if (runs.empty() || runs.back().component != component) runs.push_back({component, 0, 0});
      runs.back().volume += (a - origin).dot(normal) / 6;
      runs.back().area += normal.norm() / 2;
    }
  };
  parallel_blocks(
      blocks.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t block = begin; block < end; ++block) measure_block(block);
      },
      context, 1);
  for (const auto& runs : blocks)
    for (const FaceRun& run : runs) {
      components.volume[run.component] += run.volume;
      components.area[run.component] += run.area;
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

// Returns the inward-facing components. `is_usable` tells whether a face has a component.
template <class IsUsable>
InwardComponents find_inward(const Mesh& mesh, Components components, const IsUsable& is_usable,
                             const Context& context) {
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
      if (is_usable(f)) faces[components.component[mesh.faces[f][0]]].push_back(f);
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

}  // namespace

InwardComponents inward_components(const Mesh& mesh, const EdgeTable& table, const Context& context) {
  const auto is_usable = [&](Index f) {
    return !mesh.faces[f].empty() && table.next[mesh.faces.first_corner(f)] >= 0;
  };
  return find_inward(mesh, measure(mesh, table), is_usable, context);
}

InwardComponents inward_components(const Mesh& mesh, const SimpleSurface& surface, const Context& context) {
  return find_inward(mesh, measure(mesh, surface, context), [](Index) { return true; }, context);
}

}  // namespace meshgraft
