#include "view.h"

#include <algorithm>
#include <limits>
#include <numbers>
#include <vector>

#include <meshgraft/core/error.h>

#include "render/facts.h"

namespace meshgraft::render {

View fit_view(std::span<const Surface> surfaces, const RenderOptions& options) {
  const Camera& camera = options.camera;
  if (!(camera.from_direction.norm() > 0.0) || !(camera.up.cross(camera.from_direction).norm() > 0.0))
    throw Error(facts::render::CameraWithoutDirection{});
  Eigen::Vector3d low = camera.low, high = camera.high;
  const bool fit = (low.array() > high.array()).any();
  if (fit) {
    low.setConstant(std::numeric_limits<double>::infinity());
    high = -low;
    for (const Surface& surface : surfaces) {
      low = low.cwiseMin(surface.positions.colwise().minCoeff().transpose());
      high = high.cwiseMax(surface.positions.colwise().maxCoeff().transpose());
    }
  }
  View view;
  view.centre = 0.5 * (low + high);
  view.scale = std::max(0.5 * (high - low).stableNorm(), std::numeric_limits<double>::min());
  const Eigen::Vector3d back = camera.from_direction.normalized();
  const Eigen::Vector3d right = camera.up.cross(back).normalized();
  const Eigen::Vector3d up = back.cross(right);

  // Places the camera as near as possible with every point (or corner of the given box) visible, centred
  // between the extreme ones.
  std::vector<Eigen::Vector3d> points;
  if (fit) {
    for (const Surface& surface : surfaces)
      for (Eigen::Index v = 0; v < surface.positions.rows(); ++v)
        points.push_back((surface.positions.row(v).transpose() - view.centre) / view.scale);
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p(corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(),
                              corner & 4 ? low.z() : high.z());
      points.push_back((p - view.centre) / view.scale);
    }
  }
  constexpr double margin = 1.10;
  const double tangent_y = std::tan(0.5 * camera.field_of_view_deg * std::numbers::pi / 180.0) / margin;
  const double tangent_x = tangent_y * options.width / options.height;
  // Along each axis the four frustum planes bound the camera: |q·axis − e| ≤ tangent·(distance − q·back).
  double r_max = -1e30, r_min = -1e30, u_max = -1e30, u_min = -1e30;
  for (const Eigen::Vector3d& q : points) {
    const double depth = q.dot(back);
    r_max = std::max(r_max, q.dot(right) + tangent_x * depth);
    r_min = std::max(r_min, -q.dot(right) + tangent_x * depth);
    u_max = std::max(u_max, q.dot(up) + tangent_y * depth);
    u_min = std::max(u_min, -q.dot(up) + tangent_y * depth);
  }
  const double distance = std::max((r_max + r_min) / (2.0 * tangent_x), (u_max + u_min) / (2.0 * tangent_y));
  const Eigen::Vector3d eye = 0.5 * (r_max - r_min) * right + 0.5 * (u_max - u_min) * up + distance * back;
  view.eye = eye.cast<float>();
  view.right = right.cast<float>();
  view.up = up.cast<float>();
  view.ahead = -back.cast<float>();
  view.tangent = static_cast<float>(tangent_y * margin);
  const Eigen::Vector3d zenith = camera.up.normalized();
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& q : points) lowest = std::min(lowest, q.dot(zenith));
  for (const Surface& surface : surfaces)  // also beyond the box that is shown
    lowest = std::min(
        lowest, ((surface.positions.rowwise() - view.centre.transpose()) * zenith).minCoeff() / view.scale);
  view.zenith = zenith.cast<float>();
  view.ground = static_cast<float>(lowest) - 1e-4f;
  view.to_key = (-0.55 * right + 0.85 * zenith + 0.62 * back).cast<float>().normalized();
  view.to_fill = (0.95 * right + 0.25 * zenith + 0.45 * back).cast<float>().normalized();
  return view;
}

float spacing_at(const Vec3& point, const View& view, const RenderOptions& options) {
  return 2.0f * view.tangent * (point - view.eye).norm() / static_cast<float>(options.height);
}

}  // namespace meshgraft::render
