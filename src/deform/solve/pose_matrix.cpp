#include "pose_matrix.h"

#include <cmath>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "deform/facts.h"

namespace meshgraft {

PoseMatrix pose_matrix(const HandlePose& pose, const Eigen::RowVector3d& centre, double scale) {
  const Eigen::Matrix3d change = (pose.transform.linear() - Eigen::Matrix3d::Identity()).transpose();
  PoseMatrix frame;
  frame.topRows<3>() = change;
  frame.row(3) = (centre * change + pose.transform.translation().transpose()) / scale;
  return frame;
}

ConstrainedSystem::Known unit_frame_values(const ConstrainedSystem& system, std::span<const Handle> handles) {
  const Patch& patch = system.patch();
  ConstrainedSystem::Known values = system.no_values(static_cast<Eigen::Index>(4 * handles.size()));
  for (std::size_t h = 0; h < handles.size(); ++h) {
    const auto column = static_cast<Eigen::Index>(4 * h);
    for (const Index vertex : handles[h].vertices) {
      const Index v = patch.local(vertex);
      if (v < 0) continue;
      if (handles[h].constrain_position) values.x.row(v).segment<4>(column) << patch.points.row(v), 1.0;
      if (handles[h].constrain_transform) values.m.block<3, 3>(3 * v, column).setIdentity();
    }
  }
  return values;
}

void validate(const HandlePose& pose, const Location& location) {
  constexpr double largest = 1e100;  // so that squares and volumes stay finite
  if (!(pose.transform.affine().array().abs() < largest).all())
    throw Error(facts::deform::TooLargeOrNotFinite{.what = facts::deform::Quantity::transform}, location);
  if (pose.rotation && !(std::isfinite(pose.rotation->angle()) && pose.rotation->axis().allFinite()))
    throw Error(facts::core::NotFinite{.what = facts::core::Quantity::rotation}, location);
  if (pose.curve && !(pose.curve->array().abs() < largest).all())
    throw Error(facts::deform::TooLargeOrNotFinite{.what = facts::deform::Quantity::curve}, location);
}

void require_affine_poses(std::span<const Handle> handles, std::span<const HandlePose> poses) {
  if (poses.size() != handles.size())
    throw Error(facts::core::SizeMismatch{
        .what = facts::core::Rows::poses, .given = poses.size(), .needed = handles.size()});
  for (std::size_t h = 0; h < poses.size(); ++h) {
    const Location location = Location::handle(handles[h].name);
    if (poses[h].curve) throw Error(facts::deform::CurveNotAffine{}, location);
    validate(poses[h], location);
  }
}

}  // namespace meshgraft
