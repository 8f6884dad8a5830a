#pragma once

#include <cstdint>
#include <vector>

#include "appearance.h"
#include "corner_normals.h"
#include "view.h"

namespace meshgraft::render {

/// Tells what samples of a picture show: clay or colours, the ground, and the background.
class Painter {
 public:
  /// `lift` is the height of the points of samples above surfaces.
  Painter(const Scene& scene, const std::vector<Vec3>& points, const CornerNormals& normals, const View& view,
          const RenderOptions& options, float lift)
      : scene_(scene), points_(points), normals_(normals), view_(view), options_(options), lift_(lift) {}

  /// Returns the appearance of a place of the picture, in pixels, that shows a triangle or `no_triangle`.
  Appearance at(float x, float y, std::uint32_t triangle) const;

 private:
  Appearance surface(const Eigen::Vector3d& towards, std::uint32_t triangle) const;
  Appearance beyond(float x, float y, const Eigen::Vector3d& towards) const;

  /// Returns how much of a point a thin line along its triangle's edges covers; the line is about one pixel
  /// wide. The last argument is twice the triangle's area over the size of a pixel.
  float wire_coverage(std::uint32_t triangle, const Vec3& weights, float area2) const;

  const Scene& scene_;
  const std::vector<Vec3>& points_;
  const CornerNormals& normals_;
  const View& view_;
  const RenderOptions& options_;
  float lift_;
};

}  // namespace meshgraft::render
