#include "rotations.h"

#include <cmath>
#include <numbers>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>

namespace meshgraft {

Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (angle == 0) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

Eigen::Vector3d nearest_turn(const Eigen::Vector3d& vector, const Eigen::Vector3d& other) {
  constexpr double circle = 2 * std::numbers::pi;
  const double angle = vector.norm();
  // A full turn may be about any axis.
  const Eigen::Vector3d axis =
      angle > 1e-12 ? Eigen::Vector3d(vector / angle) : Eigen::Vector3d(other.stableNormalized());
  const double along = axis.dot(other);
  return (angle + circle * std::round((along - angle) / circle)) * axis;
}

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& map) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

bool polar_decompose(const Eigen::Matrix3d& map, PolarParts& parts) {
  constexpr double flattest = 1e-6;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& sigma = svd.singularValues();
  if (!(sigma[2] > flattest * sigma[0]) || map.determinant() < 0) return false;
  parts.rotation = svd.matrixU() * svd.matrixV().transpose();
  parts.stretch = svd.matrixV() * sigma.asDiagonal() * svd.matrixV().transpose();
  return true;
}

namespace {

template <class Function>
Eigen::Matrix3d apply_to_eigenvalues(const Eigen::Matrix3d& symmetric, Function function) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(symmetric);
  return eigen.eigenvectors() * eigen.eigenvalues().unaryExpr(function).asDiagonal() *
         eigen.eigenvectors().transpose();
}

}  // namespace

Eigen::Matrix<double, 6, 1> stretch_log(const Eigen::Matrix3d& stretch) {
  const Eigen::Matrix3d log = apply_to_eigenvalues(stretch, [](double value) { return std::log(value); });
  Eigen::Matrix<double, 6, 1> entries;
  entries << log(0, 0), log(1, 1), log(2, 2), log(1, 2), log(2, 0), log(0, 1);
  return entries;
}

Eigen::Matrix3d stretch_exp(const Eigen::Matrix<double, 6, 1>& log) {
  if (log.isZero(0)) return Eigen::Matrix3d::Identity();
  Eigen::Matrix3d symmetric;
  symmetric << log[0], log[5], log[4], log[5], log[1], log[3], log[4], log[3], log[2];
  return apply_to_eigenvalues(symmetric, [](double value) { return std::exp(value); });
}

}  // namespace meshgraft
