#include "corotation.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "rotations.h"

namespace meshgraft {

namespace {

/// Returns `map` with the image of the normal made orthogonal to the image of the surface.
Eigen::Matrix3d with_normal(const Eigen::Matrix3d& map, const Eigen::Vector3d& normal) {
  const Eigen::Vector3d u = normal.unitOrthogonal(), v = normal.cross(u);
  const Eigen::Vector3d across = (map * u).cross(map * v);
  const double length = across.norm();
  if (!(length > 0)) return map;
  return map + (across / std::sqrt(length) - map * normal) * normal.transpose();
}

}  // namespace

Eigen::Vector3d surface_turn(const Eigen::Matrix3d& map, const BlendedMap& blended,
                             const Eigen::Vector3d& normal, const Eigen::Vector3d& current) {
  const Eigen::Matrix3d unstretch = blended.stretch.inverse();
  Eigen::Matrix3d turned = map * unstretch;
  const Eigen::Vector3d stretched = unstretch.transpose() * normal;  // normal of the stretched surface
  if (!normal.isZero(0)) turned = with_normal(turned, stretched.normalized());
  const Eigen::Matrix3d rotation = nearest_rotation(turned);
  return nearest_turn(rotation_log(rotation * blended.rotation.transpose()), current);
}

}  // namespace meshgraft
