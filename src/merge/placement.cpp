#include "placement.h"

#include <numbers>

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

/// Returns the outline's first axis on the plane with this normal: turned there by the smallest rotation,
/// then spun.
Vector laid_axis(const FlatLoop& loop, const Vector& normal, double spin_deg) {
  const Eigen::AngleAxisd spin(spin_deg * std::numbers::pi / 180, normal.transpose());
  return spin * turned(loop.first_axis, loop.axis, normal).transpose();
}

}  // namespace

Vector turned(const Vector& vector, const Vector& from, const Vector& to) {
  return Eigen::Quaterniond::FromTwoVectors(from.transpose(), to.transpose()) * vector.transpose();
}

Placement place_outline(const PreparedTarget& target, const SurfacePoint& point, const FlatLoop& loop,
                        double size, double spin_deg) {
  const Vector normal = mean_normal(target, point, size * loop.outline.reach());
  return {normal, laid_axis(loop, normal, spin_deg)};
}

Eigen::Affine3d placement_map(const FlatLoop& loop, const Placement& placement, double size,
                              const Vector& centre) {
  Eigen::Matrix3d from, to;
  from << loop.first_axis.transpose(), loop.axis.cross(loop.first_axis).transpose(), loop.axis.transpose();
  to << placement.first_axis.transpose(), placement.normal.cross(placement.first_axis).transpose(),
      placement.normal.transpose();
  Eigen::Affine3d map = Eigen::Affine3d::Identity();
  map.linear() = size * to * from.transpose();
  map.translation() = centre.transpose() - map.linear() * loop.centre.transpose();
  return map;
}

}  // namespace meshgraft
