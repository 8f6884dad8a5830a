#include "boundary_condition.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "loop_curve.h"

namespace meshgraft {

namespace {

/// Returns the unit tangents of a closed polyline, by central differences.
Points tangents(const Points& points) {
  const Eigen::Index count = points.rows();
  Points result(count, 3);
  for (Eigen::Index i = 0; i < count; ++i)
    result.row(i) = (points.row((i + 1) % count) - points.row((i + count - 1) % count)).stableNormalized();
  return result;
}

/// Returns a tangent frame. Its columns are the unit tangent, the unit normal made orthogonal to it, and
/// their cross product.
Eigen::Matrix3d frame(const Eigen::RowVector3d& tangent, const Eigen::RowVector3d& normal) {
  Eigen::Matrix3d axes;
  axes.col(0) = tangent.stableNormalized().transpose();
  const Eigen::Vector3d across = normal.transpose() - normal.dot(axes.col(0)) * axes.col(0);
  axes.col(1) = across.norm() > 1e-9 ? Eigen::Vector3d(across.normalized()) : axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

/// Returns the share of the loop's length at each vertex.
Eigen::VectorXd length_shares(const Points& points) {
  const Eigen::Index count = points.rows();
  Eigen::VectorXd shares = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const double half = (points.row((i + 1) % count) - points.row(i)).norm() / 2;
    shares[i] += half;
    shares[(i + 1) % count] += half;
  }
  return shares / shares.sum();
}

struct LoopSize {
  Eigen::RowVector3d centre;  ///< centroid by arc length
  double radius = 0;          ///< root mean square distance from it

  explicit LoopSize(const Points& points) {
    const Eigen::VectorXd shares = length_shares(points);
    centre = shares.transpose() * points;
    radius = std::sqrt(shares.dot((points.rowwise() - centre).rowwise().squaredNorm()));
  }
};

Points target_points(const Points& target, const Correspondence& correspondence) {
  Points there(static_cast<Eigen::Index>(correspondence.loop_parameter.size()), 3);
  for (Eigen::Index i = 0; i < there.rows(); ++i) there.row(i) = at(target, correspondence.loop_parameter[i]);
  return there;
}

}  // namespace

std::vector<VertexConstraint> boundary_constraints(const LoopPair& pair, const LoopGeometry& source,
                                                   const LoopGeometry& target,
                                                   const Correspondence& correspondence,
                                                   const BoundaryOptions& options) {
  const LoopSize source_size(source.points), target_size(target.points);
  const Points source_tangents = tangents(source.points), target_tangents = tangents(target.points);
  const Points there = target_points(target.points, correspondence);
  constexpr double near_centre = 0.1;  // × the radius: ratios of short distances are unreliable
  std::vector<VertexConstraint> constraints;
  for (Eigen::Index i = 0; i < there.rows(); ++i) {
    const double parameter = correspondence.loop_parameter[i];
    const double distance = (source.points.row(i) - source_size.centre).norm();
    const double ratio = distance < near_centre * source_size.radius
                             ? target_size.radius / source_size.radius
                             : (there.row(i) - target_size.centre).norm() / distance;
    const double scale = options.scale.value_or(ratio);
    Eigen::Matrix3d transform = scale * Eigen::Matrix3d::Identity();
    if (options.pose == MergePose::find) {
      const Eigen::RowVector3d listed =
          at(target_tangents, parameter);  // the matched direction runs against it
      Eigen::RowVector3d normal = at(target.normals, parameter);
      if (options.normal_angle_deg != 0)
        normal = normal * Eigen::AngleAxisd(options.normal_angle_deg * std::numbers::pi / 180,
                                            listed.transpose().stableNormalized())
                              .toRotationMatrix()
                              .transpose();
      transform =
          scale * frame(-listed, normal) * frame(source_tangents.row(i), source.normals.row(i)).transpose();
    }
    constraints.push_back({pair.source[i], there.row(i).transpose(), transform});
  }
  return constraints;
}

Similarity pose_of_boundary(std::span<const LoopGeometry> sources, std::span<const LoopGeometry> targets,
                            std::span<const Correspondence> correspondences, std::optional<double> scale) {
  Eigen::Index count = 0;
  for (const LoopGeometry& loop : sources) count += 2 * loop.points.rows();
  Points from(count, 3), to(count, 3);
  Eigen::VectorXd weights(count);
  Eigen::Index row = 0;
  for (std::size_t p = 0; p < sources.size(); ++p) {
    const LoopSize source_size(sources[p].points), target_size(targets[p].points);
    const Eigen::VectorXd shares = length_shares(sources[p].points);
    for (Eigen::Index i = 0; i < sources[p].points.rows(); ++i) {
      const double parameter = correspondences[p].loop_parameter[i];
      const Eigen::RowVector3d v = sources[p].points.row(i), there = at(targets[p].points, parameter);
      const Eigen::RowVector3d normal = at(targets[p].normals, parameter).stableNormalized();
      for (const double height : {0.0, 1.0}) {  // the vertex, and the tip of its normal
        from.row(row) = v + height * source_size.radius * sources[p].normals.row(i);
        to.row(row) = there + height * target_size.radius * normal;
        weights[row++] = shares[i] * target_size.radius;
      }
    }
  }
  Similarity pose;
  if (!fit_similarity(from, to, weights, pose)) pose = {};
  if (scale) {
    const Eigen::RowVector3d from_centre = weights.transpose() * from / weights.sum(),
                             to_centre = weights.transpose() * to / weights.sum();
    pose.scale = *scale;
    pose.translation = to_centre.transpose() - pose.scale * pose.rotation * from_centre.transpose();
  }
  return pose;
}

}  // namespace meshgraft
