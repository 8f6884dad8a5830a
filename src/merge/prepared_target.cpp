#include "prepared_target.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <variant>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/normals.h>

#include "core/facts.h"
#include "core/require_between.h"
#include "merge/facts.h"
#include "mesh/box_diagonal.h"

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

/// Returns the point of a triangle nearest to `p`.
Vector nearest_in_triangle(const Vector& p, const Vector& a, const Vector& b, const Vector& c) {
  const Vector ab = b - a, ac = c - a, normal = ab.transpose().cross(ac.transpose()).transpose();
  const double square = normal.squaredNorm();
  if (square > 0) {
    const double v = (p - a).transpose().cross(ac.transpose()).dot(normal.transpose()) / square;
    const double w = ab.transpose().cross((p - a).transpose()).dot(normal.transpose()) / square;
    if (v >= 0 && w >= 0 && v + w <= 1) return a + v * ab + w * ac;
  }
  Vector best = a;
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, c}, std::pair{c, a}}) {
    const Vector edge = to - from;
    const double length = edge.squaredNorm();
    const double t = length > 0 ? std::clamp((p - from).dot(edge) / length, 0.0, 1.0) : 0.0;
    const Vector q = from + t * edge;
    if ((p - q).squaredNorm() < (p - best).squaredNorm()) best = q;
  }
  return best;
}

}  // namespace

SurfacePoint find_nearest_point(const Points& x, const Triangles& triangles, const Vector& point) {
  double least = std::numeric_limits<double>::infinity();
  SurfacePoint best{point, {}};
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const auto corners = triangles.row(t);
    const Vector q = nearest_in_triangle(point, x.row(corners[0]), x.row(corners[1]), x.row(corners[2]));
    const double distance = (q - point).norm();
    if (!(distance < least)) continue;
    least = distance;
    best = {q, {corners[0], corners[1], corners[2]}};
  }
  return best;
}

PreparedTarget::PreparedTarget(std::shared_ptr<const Mesh> shared_mesh, const Context& context)
    : PreparedTarget(shared_mesh, triangulate(*shared_mesh, {.skip_out_of_range = true}), context) {}

PreparedTarget::PreparedTarget(std::shared_ptr<const Mesh> shared_mesh, Triangulation triangulation,
                               const Context& context)
    : shared(std::move(shared_mesh)),
      mesh(*shared),
      triangles(std::move(triangulation.triangles)),
      face_of_triangle(std::move(triangulation.face)),
      rings(vertex_rings(mesh.vertex_count(), triangles, context)),
      normals(vertex_normals(mesh)) {}

void validate(const Drop& drop, const Mesh& target) {
  if (drop.size && !(*drop.size > 0 && *drop.size < 1e100))
    throw Error(facts::core::NotPositive{.value = *drop.size}, "size");
  if (!std::isfinite(drop.spin_deg))
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::angle}, "spin_deg");
  require_between(drop.spin_deg, -largest_accepted_angle_deg, largest_accepted_angle_deg, "spin_deg");
  if (const auto* point = std::get_if<Eigen::Vector3d>(&drop.surface_point);
      point != nullptr && !point->allFinite())
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::point}, "surface_point");
  const auto* vertex = std::get_if<Index>(&drop.surface_point);
  if (vertex != nullptr && (*vertex < 0 || *vertex >= target.vertex_count()))
    throw Error(facts::merge::NoSuchSurfaceVertex{.vertex = *vertex, .count = target.vertex_count()},
                "surface_point");
}

SurfacePoint locate(const PreparedTarget& target, const Drop& drop) {
  if (const auto* vertex = std::get_if<Index>(&drop.surface_point)) {
    if (target.rings[*vertex].empty())
      throw Error(facts::merge::VertexWithoutFace{.vertex = *vertex}, "surface_point");
    return {target.mesh.positions.row(*vertex), {*vertex}};
  }
  if (target.triangles.rows() == 0) throw Error(facts::merge::TargetWithoutFaces{});
  return find_nearest_point(target.mesh.positions, target.triangles,
                            std::get<Eigen::Vector3d>(drop.surface_point).transpose());
}

SurfacePoint find_surface_point(const PreparedTarget& target, const Drop& drop) {
  constexpr double near_surface = 0.05;  // × the target's diagonal
  SurfacePoint found = locate(target, drop);
  const auto* point = std::get_if<Eigen::Vector3d>(&drop.surface_point);
  if (point == nullptr) return found;
  const double distance = (found.point.transpose() - *point).norm();
  if (!(distance <= near_surface * box_diagonal(target.mesh.positions)))
    throw Error(facts::merge::PointOffSurface{.x = point->x(),
                                              .y = point->y(),
                                              .z = point->z(),
                                              .distance = distance,
                                              .nearest_x = found.point.x(),
                                              .nearest_y = found.point.y(),
                                              .nearest_z = found.point.z()},
                "surface_point");
  return found;
}

Vector mean_normal(const PreparedTarget& target, const SurfacePoint& point, double distance) {
  constexpr double wrapped = 0.3;  // chosen: normals that cancel to less come from all sides
  const Points& x = target.mesh.positions;
  const std::vector<double> away = edge_distance(point.corners, x, target.rings, {.limit = distance});
  Vector sum = Vector::Zero(), local = Vector::Zero();
  double area = 0;
  for (Eigen::Index t = 0; t < target.triangles.rows(); ++t) {
    const auto corners = target.triangles.row(t);
    if (std::none_of(corners.begin(), corners.end(), [&](Index v) { return std::isfinite(away[v]); })) continue;
    const Vector ab = x.row(corners[1]) - x.row(corners[0]), ac = x.row(corners[2]) - x.row(corners[0]);
    const Vector normal = ab.transpose().cross(ac.transpose()).transpose();
    sum += normal;
    area += normal.norm();
  }
  for (const Index v : point.corners) local += target.normals.row(v);
  return (sum.norm() > wrapped * area ? sum : local).stableNormalized();
}

}  // namespace meshgraft
