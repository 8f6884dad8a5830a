
#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/mesh/cut.h>
#include <meshgraft/mesh/topology.h>

#include "interpolate_attribute.h"
#include "join.h"
#include "winding.h"

namespace meshgraft {

Mesh turned_over(const Mesh& mesh) {
  Mesh result;
  result.positions = mesh.positions;
  result.source = sources_of(mesh);
  result.faces.reserve(mesh.face_count(), mesh.faces.corner_count());
  std::vector<EdgePoint> corner_origin;
  for (Index f = 0; f < mesh.face_count(); ++f) {
    const auto face = mesh.faces[f];
    std::vector<Index> corners(face.begin(), face.end());
    const Index first = mesh.faces.first_corner(f), count = static_cast<Index>(face.size());
    if (count > 1) std::reverse(corners.begin() + 1, corners.end());
    result.faces.push_back(corners);
    for (Index c = 0; c < count; ++c) {
      const Index old = first + (count - c) % count;
      corner_origin.push_back({old, old, 0});
    }
  }
  for (const Attribute& attribute : mesh.attributes) {
    result.attributes.push_back(
        attribute.domain == Domain::corner ? interpolate_attribute(attribute, corner_origin) : attribute);
    if (attribute.name == "normal" || attribute.name == cut_normal_name)
      for (double& value : result.attributes.back().values) value = -value;
  }
  return result;
}

double enclosed_volume(const Mesh& mesh) {
  const Triangles triangles = triangulate(mesh, {.skip_out_of_range = true}).triangles;
  if (triangles.rows() == 0) return 0;
  const Eigen::RowVector3d origin = mesh.positions.row(triangles(0, 0));
  double volume = 0, area = 0;
  const auto add = [&](const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, const Eigen::RowVector3d& c) {
    volume += (a - origin).dot((b - origin).cross(c - origin)) / 6;
    area += (b - a).cross(c - a).norm() / 2;
  };
  for (const auto& t : triangles.rowwise())
    add(mesh.positions.row(t[0]), mesh.positions.row(t[1]), mesh.positions.row(t[2]));
  const double surface = area;
  for (const auto& loop : boundary_loops(mesh)) {
    Eigen::RowVector3d centre = Eigen::RowVector3d::Zero();
    for (const Index v : loop) centre += mesh.positions.row(v);
    centre /= static_cast<double>(loop.size());
    for (std::size_t i = 0; i < loop.size(); ++i)
      add(centre, mesh.positions.row(loop[(i + 1) % loop.size()]), mesh.positions.row(loop[i]));
  }
  constexpr double widest_opening = 0.5;  // of the surface area, as for half a sphere
  if (!(area - surface <= widest_opening * surface * (1 + 1e-6))) return 0;
  const double ball = std::pow(area / std::numbers::pi, 1.5) * std::numbers::pi / 6;
  return std::isfinite(volume) ? volume / ball : 0;
}

}  // namespace meshgraft
