#include "view.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include <meshgraft/core/error.h>

#include "render/facts.h"

namespace meshgraft::render {

View fit_view(const Scene& scene, const RenderOptions& options) {
  const Camera& camera = options.camera;
  if (!(camera.from_direction.norm() > 0.0) || !(camera.up.cross(camera.from_direction).norm() > 0.0))
    throw Error(facts::render::CameraWithoutDirection{});
  Eigen::Vector3d low = camera.low, high = camera.high;
  const bool fit = (low.array() > high.array()).any();
  if (fit) {
    low.setConstant(std::numeric_limits<double>::infinity());
    high = -low;
    scene.for_each_finite_position([&](const Eigen::Vector3d& position) {
      low = low.cwiseMin(position);
      high = high.cwiseMax(position);
    });
  }
  View view;
  const Eigen::Vector3d centre = 0.5 * (low + high);
  view.scale = std::max(0.5 * (high - low).stableNorm(), std::numeric_limits<double>::min());
  const Eigen::Vector3d back = camera.from_direction.normalized();
  const Eigen::Vector3d right = camera.up.cross(back).normalized();
  const Eigen::Vector3d up = back.cross(right);

  // Places the camera as near as possible with every point (or corner of the given box) visible, centred
  // between the extreme ones. Along each axis the four frustum planes bound the camera:
  // |q·axis − e| ≤ tangent·(distance − q·back).
  constexpr double margin = 1.10;
  const double tangent_y = std::tan(0.5 * camera.field_of_view_deg * std::numbers::pi / 180.0) / margin;
  const double tangent_x = tangent_y * options.width / options.height;
  const Eigen::Vector3d zenith = camera.up.normalized();
  double r_max = -1e30, r_min = -1e30, u_max = -1e30, u_min = -1e30;
  double lowest = std::numeric_limits<double>::infinity();
  const auto include = [&](const Eigen::Vector3d& q) {
    const double depth = q.dot(back);
    r_max = std::max(r_max, q.dot(right) + tangent_x * depth);
    r_min = std::max(r_min, -q.dot(right) + tangent_x * depth);
    u_max = std::max(u_max, q.dot(up) + tangent_y * depth);
    u_min = std::max(u_min, -q.dot(up) + tangent_y * depth);
    lowest = std::min(lowest, q.dot(zenith));
  };
  for (int corner = 0; !fit && corner < 8; ++corner)
    include((Eigen::Vector3d(corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(),
                             corner & 4 ? low.z() : high.z()) -
             centre) /
            view.scale);
  scene.for_each_finite_position([&](const Eigen::Vector3d& position) {
    const Eigen::Vector3d q = (position - centre) / view.scale;
    if (fit)
      include(q);
    else
      lowest = std::min(lowest, q.dot(zenith));  // the ground is below what lies beyond the box, too
  });
  const double distance = std::max((r_max + r_min) / (2.0 * tangent_x), (u_max + u_min) / (2.0 * tangent_y));
  const Eigen::Vector3d eye = 0.5 * (r_max - r_min) * right + 0.5 * (u_max - u_min) * up + distance * back;
  view.eye = centre + view.scale * eye;
  view.axes << right.transpose(), up.transpose(), back.transpose();
  view.tangent = static_cast<float>(tangent_y * margin);
  const auto seen = [&](const Eigen::Vector3d& direction) -> Vec3 {
    return (view.axes * direction).cast<float>();
  };
  view.middle = seen(-eye);
  view.zenith = seen(zenith);
  view.ground = static_cast<float>(lowest - eye.dot(zenith) - 1e-4);
  view.to_key = seen((-0.55 * right + 0.85 * zenith + 0.62 * back).normalized());
  view.to_fill = seen((0.95 * right + 0.25 * zenith + 0.45 * back).normalized());
  view.width = static_cast<float>(options.width);
  view.height = static_cast<float>(options.height);
  return view;
}

}  // namespace meshgraft::render
