#include <meshgraft/deform/deform_problem.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/solve/rotations.h"

namespace meshgraft {

namespace {

Location location_of(const Handle& handle) { return Location::handle(handle.name); }

void require_vertices(const Handle& handle, Index vertex_count) {
  const Location location = location_of(handle);
  if (handle.vertices.empty()) throw Error(facts::deform::NoVertices{}, location);
  for (const Index v : handle.vertices) require_vertex(v, vertex_count, location);
}

void require_curve(const Handle& handle, const Points& rest) {
  require_vertices(handle, static_cast<Index>(rest.rows()));
  if (handle.shape != HandleShape::curve) throw Error(facts::deform::NotACurve{}, location_of(handle));
  const std::size_t needed = handle.closed ? 3 : 2;
  if (handle.vertices.size() < needed)
    throw Error(facts::deform::CurveTooShort{.count = handle.vertices.size(),
                                             .kind = handle.closed ? facts::deform::Kind::closed_curve
                                                                   : facts::deform::Kind::curve,
                                             .needed = needed},
                location_of(handle));
}

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

// Returns the smallest rotation that takes the unit vector a to the unit vector b. It is exactly I for a = b.
Eigen::Matrix3d smallest_rotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                  const Eigen::Vector3d& normal) {
  if (a == b) return Eigen::Matrix3d::Identity();
  const double one_plus_cosine = 0.5 * (a + b).squaredNorm();
  if (one_plus_cosine < 1e-15) return rotation_matrix(normal, sine_cosine(180));
  const Eigen::Matrix3d turn = cross_matrix(a.cross(b));
  return Eigen::Matrix3d::Identity() + turn + turn * turn / one_plus_cosine;
}

// Returns the unit component of `normal` orthogonal to the unit tangent. If it vanishes, returns any unit
// vector orthogonal to the tangent.
Eigen::Vector3d orthogonal_normal(const Eigen::Vector3d& normal, const Eigen::Vector3d& tangent) {
  const Eigen::Vector3d part = normal - normal.dot(tangent) * tangent;
  const bool usable = part.allFinite() && part.norm() > 1e-6 * normal.norm();
  return usable ? Eigen::Vector3d(part.normalized()) : tangent.unitOrthogonal();
}

// Returns the arc length from the first point to each point, followed by the total length of a closed curve.
std::vector<double> arc_lengths(const Points& curve, bool closed) {
  std::vector<double> lengths = {0};
  for (Eigen::Index k = 1; k < curve.rows(); ++k) {
    lengths.push_back(lengths.back() + (curve.row(k) - curve.row(k - 1)).norm());
  }
  if (closed) lengths.push_back(lengths.back() + (curve.row(0) - curve.row(curve.rows() - 1)).norm());
  return lengths;
}

// Returns the arc lengths divided by the total length, from 0 to 1.
std::vector<double> relative_arc_lengths(const Handle& handle, const Points& curve,
                                         facts::deform::Curve which) {
  std::vector<double> lengths = arc_lengths(curve, handle.closed);
  const double total = lengths.back();
  if (!std::isfinite(total))
    throw Error(
        facts::core::NotFinite{.what = which == facts::deform::Curve::rest ? facts::core::Quantity::rest_curve
                                                                           : facts::core::Quantity::polyline},
        location_of(handle));
  if (total == 0) throw Error(facts::deform::CurveWithoutLength{.curve = which}, location_of(handle));
  for (double& length : lengths) length /= total;
  return lengths;
}

Points rest_curve(const Handle& handle, const Points& rest) {
  Points curve(static_cast<Eigen::Index>(handle.vertices.size()), 3);
  for (Eigen::Index k = 0; k < curve.rows(); ++k) curve.row(k) = rest.row(handle.vertices[k]);
  return curve;
}

// Returns whether a closed polyline repeats its first point at its end.
bool returns_to_start(const Points& polyline) {
  return polyline.rows() > 1 && polyline.row(0) == polyline.row(polyline.rows() - 1);
}

struct CurveSample {
  Eigen::Vector3d tangent;  // unit length
  double length = 0;        // half the length of the adjoining segments
};

CurveSample sample_curve(const Handle& handle, const Points& curve, Eigen::Index k,
                         facts::deform::Curve which) {
  const Eigen::Index n = curve.rows();
  const Eigen::Index before = k > 0 ? k - 1 : handle.closed ? n - 1 : 0;
  const Eigen::Index after = k + 1 < n ? k + 1 : handle.closed ? 0 : n - 1;
  const Eigen::Vector3d incoming = curve.row(k) - curve.row(before);
  const Eigen::Vector3d outgoing = curve.row(after) - curve.row(k);
  Eigen::Vector3d direction = curve.row(after) - curve.row(before);
  if (direction.isZero(0)) direction = outgoing;  // at the tip of a hairpin
  const CurveSample sample{direction.stableNormalized(), 0.5 * (incoming.norm() + outgoing.norm())};
  if (direction.isZero(0) || !direction.allFinite() || !std::isfinite(sample.length)) {
    throw Error(facts::deform::CurveWithoutTangent{.curve = which, .point = k, .vertex = handle.vertices[k]},
                location_of(handle));
  }
  return sample;
}

}  // namespace

Eigen::Vector3d handle_pivot(const Handle& handle, const Points& rest, const IndexLists& vertex_rings) {
  require_vertices(handle, std::min(static_cast<Index>(rest.rows()), vertex_rings.size()));
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
  require_finite(std::isfinite(motion.angle_deg), facts::core::Quantity::angle, "angle_deg");
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

Points redraw_curve(const Handle& handle, const Points& rest, const Points& polyline) {
  require_curve(handle, rest);
  const bool repeats_start = handle.closed && returns_to_start(polyline);
  const Points course = polyline.topRows(polyline.rows() - (repeats_start ? 1 : 0));
  const Eigen::Index needed = handle.closed ? 3 : 2;
  if (course.rows() < needed)
    throw Error(facts::deform::PolylineTooShort{.count = course.rows(), .needed = needed}, location_of(handle));
  const std::vector<double> wanted =
      relative_arc_lengths(handle, rest_curve(handle, rest), facts::deform::Curve::rest);
  const std::vector<double> given = relative_arc_lengths(handle, course, facts::deform::Curve::polyline);

  Points redrawn(static_cast<Eigen::Index>(handle.vertices.size()), 3);
  for (Eigen::Index k = 0; k < redrawn.rows(); ++k) {
    // Finds the last point at or before the wanted length. An exact match returns that point without
    // rounding.
    const auto above = std::upper_bound(given.begin(), given.end(), wanted[k]);
    const Eigen::Index from = above - given.begin() - 1;
    if (wanted[k] == given[from] && from < course.rows()) {
      redrawn.row(k) = course.row(from);
      continue;
    }
    const double share = (wanted[k] - given[from]) / (given[from + 1] - given[from]);
    const auto a = course.row(from);
    const auto b = course.row((from + 1) % course.rows());
    redrawn.row(k) = a + share * (b - a);
  }
  return redrawn;
}

std::vector<VertexConstraint> curve_constraints(const Handle& handle, const RestSurface& rest,
                                                const Points& redrawn) {
  require_curve(handle, rest.points);
  const Points curve = rest_curve(handle, rest.points);
  if (redrawn.rows() != curve.rows())
    throw Error(
        facts::core::SizeMismatch{
            .what = facts::core::Rows::redrawn_points, .given = redrawn.rows(), .needed = curve.rows()},
        location_of(handle));
  if (rest.normals.rows() != rest.points.rows())
    throw Error(facts::core::SizeMismatch{.what = facts::core::Rows::rest_normals,
                                          .given = rest.normals.rows(),
                                          .needed = rest.points.rows()},
                location_of(handle));
  std::vector<VertexConstraint> constraints;
  for (Eigen::Index k = 0; k < curve.rows(); ++k) {
    VertexConstraint constraint;
    constraint.vertex = handle.vertices[k];
    if (handle.constrain_position) constraint.position = redrawn.row(k).transpose();
    if (handle.constrain_transform) {
      const CurveSample before = sample_curve(handle, curve, k, facts::deform::Curve::rest);
      const CurveSample after = sample_curve(handle, redrawn, k, facts::deform::Curve::redrawn);
      // Fu & Tai 2005, section 4: new frame = Q · old frame. So R = new · oldᵀ = Q for any normal.
      const Eigen::Vector3d normal =
          orthogonal_normal(rest.normals.row(constraint.vertex).transpose(), before.tangent);
      constraint.transform =
          after.length / before.length * smallest_rotation(before.tangent, after.tangent, normal);
    }
    constraints.push_back(constraint);
  }
  return constraints;
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
