#include "corner_normals.h"

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "core/parallel.h"
#include "visible_triangles.h"

namespace meshgraft::render {

CornerNormals::CornerNormals(const std::vector<Vec3>& points, const Triangles& triangles,
                             const RenderOptions& options, const Context& context)
    : points_(points),
      triangles_(triangles),
      smooth_(options.smooth),
      least_cosine_(static_cast<float>(std::cos(options.crease_angle_deg * std::numbers::pi / 180.0))),
      slots_(static_cast<std::size_t>(triangles.rows()), no_triangle) {
  if (smooth_) around_ = vertex_triangles(static_cast<Index>(points.size()), triangles, context);
}

void CornerNormals::add(const std::vector<std::uint32_t>& seen, const Context& context) {
  std::vector<std::uint32_t> added;
  for (const std::uint32_t triangle : seen) {
    if (triangle == no_triangle || slots_[triangle] != no_triangle) continue;
    slots_[triangle] = static_cast<std::uint32_t>(normals_.size() + added.size());
    added.push_back(triangle);
  }
  const std::size_t known = normals_.size();
  normals_.resize(known + added.size());
  parallel_blocks(
      added.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k)
          for (int corner = 0; corner < 3; ++corner)
            normals_[known + k][static_cast<std::size_t>(corner)] = normal_at(added[k], corner);
      },
      context, 1024);
}

Vec3 CornerNormals::area_vector(Index triangle) const {
  const auto corners = triangles_.row(triangle);
  const auto point = [&](int c) -> const Vec3& { return points_[static_cast<std::size_t>(corners[c])]; };
  return (point(1) - point(0)).cross(point(2) - point(0));
}

Vec3 CornerNormals::normal_at(std::uint32_t triangle, int corner) const {
  const auto own = static_cast<Index>(triangle);
  const Vec3 flat = area_vector(own);
  Vec3 sum = flat;
  if (smooth_)
    for (const Index other : around_[triangles_(own, corner)]) {
      if (other == own) continue;
      const Vec3 beside = area_vector(other);
      if (beside.dot(flat) > least_cosine_ * beside.norm() * flat.norm()) sum += beside;
    }
  return sum.normalized();
}

}  // namespace meshgraft::render
