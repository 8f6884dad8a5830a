// Handles whose curve is redrawn: their new positions and local transforms.
#include <meshgraft/deform/deform_problem.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "deform/facts.h"
#include "deform/setup/checks.h"
#include "deform/solve/rotations.h"

namespace meshgraft {

namespace {

Location location_of(const Handle& handle) { return Location::handle(handle.name); }

void require_curve(const Handle& handle, const Points& rest) {
  require_handle_vertices(handle, static_cast<Index>(rest.rows()));
  if (handle.shape != HandleShape::curve) throw Error(facts::deform::NotACurve{}, location_of(handle));
  const std::size_t needed = handle.closed ? 3 : 2;
  if (handle.vertices.size() < needed)
    throw Error(facts::deform::CurveTooShort{.count = handle.vertices.size(),
                                             .kind = handle.closed ? facts::deform::Kind::closed_curve
                                                                   : facts::deform::Kind::curve,
                                             .needed = needed},
                location_of(handle));
}

// Returns the rotation by 180° about a unit axis.
Eigen::Matrix3d half_turn(const Eigen::Vector3d& unit_axis) {
  return 2 * unit_axis * unit_axis.transpose() - Eigen::Matrix3d::Identity();
}

// Returns the smallest rotation that takes the unit vector a to the unit vector b. It is exactly I for a = b.
Eigen::Matrix3d smallest_rotation(const Eigen::Vector3d& a, const Eigen::Vector3d& b,
                                  const Eigen::Vector3d& normal) {
  if (a == b) return Eigen::Matrix3d::Identity();
  const double one_plus_cosine = 0.5 * (a + b).squaredNorm();
  if (one_plus_cosine < 1e-15) return half_turn(normal);
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

// Returns the length that belongs to each vertex of a curve: half of each adjoining segment.
Eigen::VectorXd vertex_lengths(const Handle& handle, const Points& curve) {
  const std::vector<double> at = arc_lengths(curve, handle.closed);
  const Eigen::Index n = curve.rows();
  Eigen::VectorXd lengths = Eigen::VectorXd::Zero(n);
  for (std::size_t k = 1; k < at.size(); ++k) {
    const double half = 0.5 * (at[k] - at[k - 1]);
    lengths[static_cast<Eigen::Index>(k) - 1] += half;
    lengths[static_cast<Eigen::Index>(k) % n] += half;
  }
  return lengths;
}

void require_redrawn(const Handle& handle, const Points& redrawn) {
  const auto needed = static_cast<Eigen::Index>(handle.vertices.size());
  if (redrawn.rows() != needed)
    throw Error(
        facts::core::SizeMismatch{
            .what = facts::core::Rows::redrawn_points, .given = redrawn.rows(), .needed = needed},
        location_of(handle));
}

// A curve is straight where the second singular value of its covariance is below this share of its size
// squared: its width is a thousandth of its size. It is a little below 1e-6, so that rounding does not matter
// there.
constexpr double straight = 0.98e-6;

// Subtracts the mean that the weights give.
Points centred(const Points& points, const Eigen::VectorXd& weights) {
  const Points from_first = points.rowwise() - points.row(0);  // keeps precision far from the origin
  const Eigen::RowVector3d mean = (weights.transpose() * from_first) / weights.sum();
  return from_first.rowwise() - mean;
}

// A vertex of a curve: its tangents before and after the curve is redrawn, and a direction across the first.
// All have unit length.
struct TangentTurn {
  Eigen::Vector3d before, after, across;
  double stretch = 1;  // ratio of the lengths

  Eigen::Matrix3d smallest() const { return smallest_rotation(before, after, across); }
};

std::vector<TangentTurn> tangent_turns(const Handle& handle, const RestSurface& rest, const Points& curve,
                                       const Points& redrawn) {
  std::vector<TangentTurn> turns;
  for (Eigen::Index k = 0; k < curve.rows(); ++k) {
    const CurveSample before = sample_curve(handle, curve, k, facts::deform::Curve::rest);
    const CurveSample after = sample_curve(handle, redrawn, k, facts::deform::Curve::redrawn);
    const Eigen::Vector3d normal = rest.normals.row(handle.vertices[k]).transpose();
    turns.push_back({before.tangent, after.tangent, orthogonal_normal(normal, before.tangent),
                     after.length / before.length});
  }
  return turns;
}

// Returns a curve about its mean, relative to its size.
Points of_unit_size(const Points& curve, const Eigen::VectorXd& weights) {
  const Points about_mean = centred(curve, weights);
  const double size = std::sqrt(weights.dot(about_mean.rowwise().squaredNorm()));
  return size > 0 ? Points(about_mean / size) : about_mean;
}

// The proper rotation that fits a redrawn curve best to the curve at rest in the least-squares sense, weighted
// by arc length (Kabsch 1976).
struct CurveFit {
  Eigen::Matrix3d covariance;  // relative to the sizes of both curves
  Eigen::Matrix3d rotation;
  double misfit = 0;  // half the squared distance of the turned from the redrawn curve, relative to the size
  double width = 0;   // second singular value of the covariance plus the third, which is less where it mirrors
  double narrowness = 0;  // from 0, where the first two singular values are alike, to 1 of a straight curve
  bool mirrors = false;   // the curves are flat, and the rotation turns over the plane of the first
};

CurveFit fit_curve(const Points& before, const Points& after, const Eigen::VectorXd& weights) {
  CurveFit fit;
  fit.covariance = after.transpose() * weights.asDiagonal() * before;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(fit.covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix3d& u = svd.matrixU();
  const Eigen::Matrix3d& v = svd.matrixV();
  const Eigen::Vector3d& sigma = svd.singularValues();
  const double sign = u.determinant() * v.determinant() < 0 ? -1 : 1;
  fit.rotation = u * Eigen::Vector3d(1, 1, sign).asDiagonal() * v.transpose();
  fit.misfit = 0.5 * weights.dot((before * fit.rotation.transpose() - after).rowwise().squaredNorm());
  fit.width = sigma[1] + sign * sigma[2];
  fit.narrowness = std::max(0.0, 1 - fit.width / sigma[0]);
  constexpr double flat = 0.1;           // a third of the width
  constexpr double within_plane = 1e-3;  // 2.5°
  fit.mirrors =
      fit.width >= straight && sigma[2] <= flat * sigma[1] && sign * u.col(2).dot(v.col(2)) < within_plane - 1;
  return fit;
}

// Returns how far a value has come from one to another, from 0 to 1.
double ramp(double value, double from, double to) { return std::clamp((value - from) / (to - from), 0.0, 1.0); }

// The surface along a curve that lies in its tangent plane.
struct CurvePlane {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // of the surface, its mean
  double hold =
      0;  // weight of the normal in the covariance; above its width, the redrawn curve stays in the plane
};

// Returns the plane in which a redrawn curve stays. That is the tangent plane of the surface if the curve lies
// in it before and after it is redrawn. The curves are of unit size. Each of the limits fades out, so that the
// plane holds the less the less it is one.
CurvePlane plane_of_curve(const Points& before, const Points& after, const Points& normals,
                          const Eigen::VectorXd& weights) {
  const Eigen::Vector3d mean = (weights.transpose() * normals).transpose() / weights.sum();
  const double agreement = ramp(mean.norm(), 0.9, 0.97);  // 1: normals within some 25° of their mean
  if (!(agreement > 0)) return {};
  CurvePlane plane{mean.normalized()};
  Eigen::Matrix<double, 3, 2> axes;
  axes.col(0) = plane.normal.unitOrthogonal();
  axes.col(1) = plane.normal.cross(axes.col(0));
  const Eigen::MatrixX2d flat_before = before * axes, flat_after = after * axes;
  const Eigen::VectorXd above_before = before * plane.normal, above_after = after * plane.normal;
  const Eigen::Matrix2d spread = flat_before.transpose() * weights.asDiagonal() * flat_before;
  const Eigen::Matrix2d covariance = flat_after.transpose() * weights.asDiagonal() * flat_before;
  const Eigen::Vector2d sizes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d>(spread).eigenvalues();
  const double width = sizes[0];  // squared
  const double bent = ramp(width, straight * sizes[1], 4 * straight * sizes[1]);
  if (!(bent > 0)) return {};
  // A wide curve, such as a ring, becomes no mirror image within the plane: its inside would have to come out.
  const double narrow = ramp(1 - width / sizes[1], 0, 0.5);
  const double rise = weights.dot(above_before.cwiseAbs2()) / width;
  const double lift = weights.dot((above_after - above_before).cwiseAbs2()) / width;
  const double flat = (1 - ramp(rise, 0.03, 0.08)) * (1 - ramp(lift, 0.07, 0.25));  // up to 15° and 30°
  // 1 for a curve that is only turned within the plane, below 0 for one that is mirrored.
  const double kept = covariance.determinant() / spread.determinant();
  const double sure = agreement * bent * narrow * flat * (1 - ramp(kept, 0, 0.5));
  plane.hold = 2 * sure * Eigen::JacobiSVD<Eigen::Matrix2d>(covariance).singularValues()[1];
  return plane;
}

// Returns the turn of a curve as a whole: the rotation of the fit for a similar copy. What is no copy tells
// little of how a narrow curve turns about itself: over a line with a slight dip, an arch would fit best upside
// down. The smallest rotations of the tangents are therefore added to the covariance, by the misfit of a narrow
// curve; and to that of a straight curve, whose turn about itself is unknown. So is the normal of a plane that
// holds the curve.
Eigen::Matrix3d turn_of_curve(const CurveFit& fit, const CurvePlane& plane,
                              const std::vector<TangentTurn>& tangents, const Eigen::VectorXd& weights) {
  Eigen::Matrix3d mean = Eigen::Matrix3d::Zero();
  for (std::size_t k = 0; k < tangents.size(); ++k)
    mean += weights[static_cast<Eigen::Index>(k)] / weights.sum() * tangents[k].smallest();
  constexpr double trust = 4;  // in the tangents; an arch over a dip of half its height stands upright
  const double share =
      trust * fit.narrowness * fit.narrowness * fit.misfit + std::max(0.0, straight - fit.width);
  return nearest_rotation(fit.covariance + share * mean + plane.hold * plane.normal * plane.normal.transpose());
}

}  // namespace

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

namespace {

// A curve that is redrawn with its transforms.
struct RedrawnCurve {
  std::vector<TangentTurn> tangents;
  CurveFit fit;
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();  // of the curve as a whole
};

RedrawnCurve turned_curve(const Handle& handle, const RestSurface& rest, const Points& redrawn) {
  const Points curve = rest_curve(handle, rest.points);
  const Eigen::VectorXd weights = vertex_lengths(handle, curve);
  RedrawnCurve turned{.tangents = tangent_turns(handle, rest, curve, redrawn)};
  if (centred(curve, weights) == centred(redrawn, weights)) return turned;
  const Points before = of_unit_size(curve, weights), after = of_unit_size(redrawn, weights);
  turned.fit = fit_curve(before, after, weights);
  const CurvePlane plane = plane_of_curve(before, after, rest.normals(handle.vertices, Eigen::all), weights);
  turned.turn = turn_of_curve(turned.fit, plane, turned.tangents, weights);
  return turned;
}

void require_normals(const Handle& handle, const RestSurface& rest) {
  if (rest.normals.rows() != rest.points.rows())
    throw Error(facts::core::SizeMismatch{.what = facts::core::Rows::rest_normals,
                                          .given = rest.normals.rows(),
                                          .needed = rest.points.rows()},
                location_of(handle));
}

}  // namespace

bool is_mirror_image(const Handle& handle, const RestSurface& rest, const Points& redrawn) {
  require_curve(handle, rest.points);
  require_redrawn(handle, redrawn);
  require_normals(handle, rest);
  if (!handle.constrain_transform) return false;
  const RedrawnCurve turned = turned_curve(handle, rest, redrawn);
  constexpr double close = 0.5;  // some 20°
  return turned.fit.mirrors && (turned.turn - turned.fit.rotation).norm() < close;
}

std::vector<VertexConstraint> curve_constraints(const Handle& handle, const RestSurface& rest,
                                                const Points& redrawn) {
  require_curve(handle, rest.points);
  require_redrawn(handle, redrawn);
  require_normals(handle, rest);
  const RedrawnCurve turned = handle.constrain_transform ? turned_curve(handle, rest, redrawn) : RedrawnCurve();
  std::vector<VertexConstraint> constraints;
  for (Eigen::Index k = 0; k < redrawn.rows(); ++k) {
    VertexConstraint constraint;
    constraint.vertex = handle.vertices[k];
    if (handle.constrain_position) constraint.position = redrawn.row(k).transpose();
    if (handle.constrain_transform) {
      const TangentTurn& tangent = turned.tangents[k];
      // Fu & Tai 2005, section 4: new frame = Q · old frame. The frame turns with the curve first.
      const Eigen::Matrix3d rotation =
          smallest_rotation(turned.turn * tangent.before, tangent.after, turned.turn * tangent.across) *
          turned.turn;
      constraint.transform = tangent.stretch * rotation;
    }
    constraints.push_back(constraint);
  }
  return constraints;
}

}  // namespace meshgraft
