#include <meshgraft/deform/deform_problem.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "core/require_between.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/solve/rotations.h"

namespace meshgraft {

namespace {

// The sine and cosine of an angle in degrees, exact at multiples of 90°.
struct SineCosine {
  double sine, cosine;
};

SineCosine sine_cosine(double angle_deg) {
  const double within_turn = std::remainder(angle_deg, 360.0);
  const double quarter = std::round(within_turn / 90);
  const double rest = (within_turn - 90 * quarter) * std::numbers::pi / 180;
  const double s = std::sin(rest), c = std::cos(rest);
  switch ((static_cast<int>(quarter) + 4) % 4) {
    case 1: return {c, -s};
    case 2: return {-s, -c};
    case 3: return {-c, s};
    default: return {s, c};
  }
}

// Returns the rotation matrix by Rodrigues' formula.
Eigen::Matrix3d rotation_matrix(const Eigen::Vector3d& unit_axis, const SineCosine& angle) {
  return angle.cosine * Eigen::Matrix3d::Identity() + angle.sine * cross_matrix(unit_axis) +
         (1 - angle.cosine) * unit_axis * unit_axis.transpose();
}

}  // namespace

Eigen::Vector3d handle_pivot(const Handle& handle, const Points& rest, const IndexLists& vertex_rings) {
  require_handle_vertices(handle, std::min(static_cast<Index>(rest.rows()), vertex_rings.size()));
  Flags inside(vertex_rings.size(), false);
  for (const Index v : handle.vertices) inside[v] = true;
  std::vector<Index> boundary;
  for (const Index v : handle.vertices) {
    const auto ring = vertex_rings[v];
    if (std::any_of(ring.begin(), ring.end(), [&](Index w) { return !inside[w]; })) boundary.push_back(v);
  }
  if (boundary.empty()) boundary = handle.vertices;
  // Sums differences to the first vertex, which keeps precision far from the origin.
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  for (const Index v : boundary) sum += rest.row(v) - rest.row(boundary[0]);
  return (rest.row(boundary[0]) + sum / static_cast<double>(boundary.size())).transpose();
}

HandlePose make_pose(const HandleMotion& motion, const Eigen::Vector3d& default_pivot) {
  const Eigen::Vector3d pivot = motion.pivot.value_or(default_pivot);
  const auto require_finite = [](bool finite, facts::core::Quantity what, const char* field) {
    if (!finite) throw Error(facts::core::NotFinite{.what = what}, field);
  };
  require_finite(motion.translate.allFinite(), facts::core::Quantity::translation, "translate");
  require_finite(motion.axis.allFinite(), facts::core::Quantity::axis, "axis");
  for (const double length : motion.translate) require_between(length, -1e100, 1e100, "translate");
  require_finite(std::isfinite(motion.angle_deg), facts::core::Quantity::angle, "angle_deg");
  require_between(motion.angle_deg, -largest_accepted_angle_deg, largest_accepted_angle_deg, "angle_deg");
  require_finite(motion.scale.allFinite(), facts::core::Quantity::scale, "scale");
  require_finite(pivot.allFinite(), facts::core::Quantity::pivot, "pivot");
  if (motion.axis.isZero(0) && motion.angle_deg != 0) throw Error(facts::deform::AxisWithoutLength{}, "axis");
  const Eigen::Vector3d axis =
      motion.axis.isZero(0) ? Eigen::Vector3d(Eigen::Vector3d::UnitZ()) : motion.axis.stableNormalized();

  const Eigen::Matrix3d linear =
      rotation_matrix(axis, sine_cosine(motion.angle_deg)) * motion.scale.asDiagonal();
  HandlePose pose;
  pose.transform.linear() = linear;
  // x' = c + t + R S (x − c). c − R S c is added first, so that a pure translation is exact.
  pose.transform.translation() = motion.translate + (pivot - linear * pivot);
  pose.rotation = Eigen::AngleAxisd(motion.angle_deg * std::numbers::pi / 180, axis);
  return pose;
}

HandlePose reflected(const HandlePose& pose, const Eigen::Affine3d& reflection) {
  const Eigen::Matrix3d s = reflection.linear(), a = pose.transform.linear();
  const Eigen::Vector3d m = reflection.translation();
  HandlePose image;
  if (a == Eigen::Matrix3d::Identity()) {  // S S = I, without rounding
    image.transform.translation() = s * pose.transform.translation();
  } else {
    image.transform.linear() = s * a * s;
    image.transform.translation() = s * (a * m + pose.transform.translation()) + m;
  }
  if (pose.rotation)
    image.rotation = Eigen::AngleAxisd(-pose.rotation->angle(), (s * pose.rotation->axis()).normalized());
  if (pose.curve) {
    image.curve.emplace(pose.curve->rows(), 3);
    for (Eigen::Index k = 0; k < pose.curve->rows(); ++k)
      image.curve->row(k) = (reflection * pose.curve->row(k).transpose()).transpose();
  }
  return image;
}

std::vector<VertexConstraint> handle_constraints(const Handle& handle, const HandlePose& pose,
                                                 const RestSurface& rest) {
  if (pose.curve) return curve_constraints(handle, rest, *pose.curve);
  std::vector<VertexConstraint> constraints;
  constraints.reserve(handle.vertices.size());
  for (const Index v : handle.vertices) {
    VertexConstraint constraint{.vertex = v};
    if (handle.constrain_position) constraint.position = pose.transform * rest.points.row(v).transpose();
    if (handle.constrain_transform) {
      constraint.transform = pose.transform.linear();
      constraint.rotation = pose.rotation;
    }
    constraints.push_back(constraint);
  }
  return constraints;
}

}  // namespace meshgraft
