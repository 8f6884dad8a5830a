#include "footprint.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include <Eigen/Geometry>

#include "exponential_map.h"
#include "merge/facts.h"
#include "mesh/edge_table.h"

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

/// Returns the vertices within the outline that are connected to the deepest one.
std::vector<Index> connected_inside(const std::vector<double>& values, const IndexLists& rings) {
  const auto deepest = std::min_element(values.begin(), values.end());
  if (deepest == values.end() || *deepest >= 0) return {};
  std::vector<Index> inside{static_cast<Index>(deepest - values.begin())};
  Flags seen(values.size(), false);
  seen[inside.front()] = true;
  for (std::size_t k = 0; k < inside.size(); ++k)
    for (const Index v : rings[inside[k]]) {
      if (seen[v] || values[v] >= 0) continue;
      seen[v] = true;
      inside.push_back(v);
    }
  return inside;
}

Footprint cover(const Outline& outline, double scale, const PlanePoints& uv, const IndexLists& rings) {
  std::vector<double> values(uv.rows(), scale * outline.reach());
  const double surely_outside = most_widened * scale * outline.reach();
  for (Eigen::Index v = 0; v < uv.rows(); ++v)
    if (uv.row(v).norm() <= surely_outside)  // false for NaN
      values[v] = scale * outline.signed_distance(uv.row(v) / scale);
  Footprint footprint{uv, values, connected_inside(values, rings), scale};
  for (double& value : footprint.values) value = std::abs(value);
  for (const Index v : footprint.inside) footprint.values[v] = values[v];
  return footprint;
}

/// Widens the outline where the surface curves away under it, until the footprint is as wide as the outline
/// in the plane.
Footprint cover_as_wide(const PreparedTarget& target, const Outline& outline, double size,
                        const PlanePoints& uv) {
  constexpr int steps = 4;
  double widened = 1;
  for (int step = 0;; ++step) {
    Footprint footprint = cover(outline, size * widened, uv, target.rings);
    if (step == steps || footprint.inside.empty()) return footprint;
    const double ratio = width_of(target, footprint) / (size * outline.width());
    widened = std::clamp(widened / std::max(ratio, 0.1), 1 / most_widened, most_widened);
  }
}

/// Returns the Euler characteristic of the vertices, edges and triangles that lie wholly within the outline:
/// 1 for a disc.
std::ptrdiff_t inner_euler_characteristic(const PreparedTarget& target, const Footprint& footprint) {
  const auto is_inside = [&](Index v) { return footprint.is_inside(v); };
  std::ptrdiff_t half_edges = 0, faces = 0;
  for (const Index v : footprint.inside)
    half_edges += std::count_if(target.rings[v].begin(), target.rings[v].end(), is_inside);
  for (const auto& t : target.triangles.rowwise()) faces += std::all_of(t.begin(), t.end(), is_inside) ? 1 : 0;
  return std::ssize(footprint.inside) - half_edges / 2 + faces;
}

}  // namespace

Chart make_chart(PreparedTarget target, SurfacePoint point, double radius, const Context& context) {
  const Vector normal = mean_normal(target, point, 0), axis = normal.transpose().unitOrthogonal().transpose();
  PlanePoints uv = exponential_map(target.mesh.positions, target.normals, target.rings,
                                   {point.point, normal, axis, point.corners}, radius, context);
  return {std::move(target), std::move(point), normal, axis, std::move(uv)};
}

double width_of(const PreparedTarget& target, const Footprint& footprint) {
  Eigen::Vector3d double_area = Eigen::Vector3d::Zero();
  const Vector origin = target.mesh.positions.row(footprint.inside.front());
  for (Eigen::Index t = 0; t < target.triangles.rows(); ++t) {
    Eigen::Vector3d out = Eigen::Vector3d::Zero(), in = Eigen::Vector3d::Zero();
    for (int c = 0; c < 3; ++c) {
      const Index a = target.triangles(t, c), b = target.triangles(t, (c + 1) % 3);
      if (footprint.is_inside(a) == footprint.is_inside(b)) continue;
      const double s = footprint.values[a] / (footprint.values[a] - footprint.values[b]);
      (footprint.is_inside(a) ? out : in) =
          ((1 - s) * target.mesh.positions.row(a) + s * target.mesh.positions.row(b) - origin).transpose();
    }
    double_area += in.cross(out);
  }
  return std::sqrt(double_area.norm() / 2);
}

Footprint lay_outline(const Chart& chart, const Outline& outline, double size, const Placement& placement) {
  const Vector axis = turned(placement.first_axis, placement.normal, chart.normal);
  const double x = axis.dot(chart.first_axis), y = axis.dot(chart.normal.cross(chart.first_axis));
  Eigen::Matrix2d turn;
  turn << x, -y, y, x;
  return cover_as_wide(chart.target, outline, size, chart.uv * turn);
}

std::optional<Note> find_obstacle(const PreparedTarget& target, const Footprint& footprint, double size,
                                  const std::function<Index(Index)>& index_of) {
  if (footprint.inside.empty()) return facts::merge::LoopSmallerThanFaces{.size = size};
  std::vector<Index> around;
  bool crossed = false;
  for (Eigen::Index t = 0; t < target.triangles.rows(); ++t) {
    const auto corners = target.triangles.row(t);
    const auto count =
        std::count_if(corners.begin(), corners.end(), [&](Index v) { return footprint.is_inside(v); });
    if (count > 0) around.insert(around.end(), corners.begin(), corners.end());
    crossed = crossed || (count > 0 && count < 3);
  }
  if (!crossed) return facts::merge::LoopLargerThanSurface{.size = size};
  const Eigen::Map<const Triangles> star(around.data(), static_cast<Eigen::Index>(around.size()) / 3, 3);
  const Mesh patch = make_mesh(target.mesh.positions, star);
  const EdgeTable table(patch.vertex_count(), patch.faces);
  for (Index e = 0; e < table.edge_count(); ++e) {
    const auto& [a, b] = table.ends[e];
    if (!footprint.is_inside(a) && !footprint.is_inside(b)) continue;
    const auto along = table.half_edges[e];
    const auto tail = [&](std::size_t k) { return patch.faces.corners()[along[k]]; };
    if (along.size() > 2 || (along.size() == 2 && tail(0) == tail(1)))
      return facts::merge::HoleNotManifold{.vertex = index_of(a), .other_vertex = index_of(b), .size = size};
  }
  for (const std::vector<Index>& loop : boundary_loops(patch))
    for (const Index v : loop)
      if (footprint.is_inside(v)) return facts::merge::HoleReachesBoundary{.vertex = index_of(v), .size = size};
  if (inner_euler_characteristic(target, footprint) != 1) return facts::merge::HoleNotDisc{.size = size};
  return std::nullopt;
}

std::optional<RefineResult> refine_around(const Mesh& mesh, const Footprint& footprint, double longest,
                                          const Context& context) {
  const auto is_long = [&](Index a, Index b) {
    if (!footprint.uv.row(a).allFinite() || !footprint.uv.row(b).allFinite()) return false;
    const double length = (mesh.positions.row(a) - mesh.positions.row(b)).norm();
    const auto depth = [&](Index v) { return std::abs(footprint.values[v]); };
    return length > longest && std::min(depth(a), depth(b)) <= length;
  };
  bool any = false;
  for (Index f = 0; f < mesh.face_count() && !any; ++f) {
    const auto face = mesh.faces[f];
    for (std::size_t c = 0; c < face.size(); ++c)
      for (std::size_t d = 0; d < c; ++d) any = any || is_long(face[c], face[d]);
  }
  if (!any) return std::nullopt;
  return split_edges(mesh, is_long, context);
}

}  // namespace meshgraft
