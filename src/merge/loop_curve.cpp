#include "loop_curve.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>

namespace meshgraft {

LoopCurve::LoopCurve(const Points& points) : arcs_{0.0} {
  const Eigen::Index count = points.rows();
  for (Eigen::Index i = 0; i < count; ++i)
    arcs_.push_back(arcs_.back() + (points.row((i + 1) % count) - points.row(i)).norm());
}

double LoopCurve::length_between(Index from, Index to) const {
  return from < to ? arcs_[to] - arcs_[from] : length() - arcs_[from] + arcs_[to];
}

double LoopCurve::parameter_at(double arc) const {
  arc -= std::floor(arc / length()) * length();
  const auto after = std::upper_bound(arcs_.begin() + 1, arcs_.end() - 1, arc);
  const auto k = after - arcs_.begin() - 1;
  const double edge = *after - arcs_[k];
  const double t = edge > 0 ? std::clamp((arc - arcs_[k]) / edge, 0.0, 1.0) : 0.0;
  return static_cast<double>(k) + t;
}

Eigen::RowVector3d at(const Points& values, double parameter) {
  const double floor = std::floor(parameter), t = parameter - floor;
  const auto k = static_cast<Eigen::Index>(floor) % values.rows();
  if (t == 0) return values.row(k);
  return (1 - t) * values.row(k) + t * values.row((k + 1) % values.rows());
}

Eigen::RowVector3d loop_axis(const Points& points) {
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  const Eigen::RowVector3d origin = points.colwise().mean();
  for (Eigen::Index i = 0; i < points.rows(); ++i)
    sum += (points.row(i) - origin).cross(points.row((i + 1) % points.rows()) - origin);
  return sum.stableNormalized();
}

bool fit_similarity(const Points& from, const Points& to, const Eigen::VectorXd& weights, Similarity& best) {
  const double total = weights.sum();
  const Eigen::RowVector3d from_centre = weights.transpose() * from / total,
                           to_centre = weights.transpose() * to / total;
  Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
  double spread = 0;
  for (Eigen::Index i = 0; i < from.rows(); ++i) {
    const Eigen::RowVector3d a = from.row(i) - from_centre, b = to.row(i) - to_centre;
    H += weights[i] * b.transpose() * a;
    spread += weights[i] * a.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(H, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d sigma = svd.singularValues();
  constexpr double on_a_line = 1e-3;
  if (!(spread > 0) || sigma[1] <= on_a_line * sigma[0]) return false;
  Eigen::Vector3d signs(1, 1, (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1);
  best.rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  best.scale = sigma.dot(signs) / spread;
  best.translation = to_centre.transpose() - best.scale * best.rotation * from_centre.transpose();
  return best.scale > 0;
}

}  // namespace meshgraft
