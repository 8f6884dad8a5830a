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

Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& vector) {
  const double square = vector.squaredNorm(), angle = std::sqrt(square);
  const Eigen::Matrix3d cross = cross_matrix(vector);
  // Taylor series near zero, where the quotients lose their digits
  const double first = angle < 1e-3 ? 0.5 - square / 24 : (1 - std::cos(angle)) / square;
  const double second = angle < 1e-3 ? 1.0 / 6 - square / 120 : (angle - std::sin(angle)) / (square * angle);
  return Eigen::Matrix3d::Identity() - first * cross + second * cross * cross;
}

Eigen::Vector3d nearest_turn(const Eigen::Vector3d& vector, const Eigen::Vector3d& other) {
  constexpr double circle = 2 * std::numbers::pi;
  // Less than half a turn lies between short vectors, which are usual.
  if (vector.squaredNorm() + other.squaredNorm() < 0.5 * std::numbers::pi * std::numbers::pi) return vector;
  const double angle = vector.norm();
  // The axis of a full turn is arbitrary.
  const Eigen::Vector3d axis =
      angle > 1e-12 ? Eigen::Vector3d(vector / angle) : Eigen::Vector3d(other.stableNormalized());
  const double along = axis.dot(other);
  const double turns = std::round((along - angle) / circle);
  return turns == 0 ? vector : Eigen::Vector3d((angle + circle * turns) * axis);
}

namespace {

/// Returns the cofactor matrix, (M⁻¹)ᵀ det M.
Eigen::Matrix3d cofactors(const Eigen::Matrix3d& m) {
  Eigen::Matrix3d result;
  result << m.col(1).cross(m.col(2)), m.col(2).cross(m.col(0)), m.col(0).cross(m.col(1));
  return result;
}

Eigen::Matrix3d nearest_rotation_by_svd(const Eigen::Matrix3d& map) {
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Matrix3d u = svd.matrixU();
  if ((u * svd.matrixV().transpose()).determinant() < 0) u.col(2) = -u.col(2);
  return u * svd.matrixV().transpose();
}

}  // namespace

Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& map) {
  // The rotation in closed form but for one number, the largest value λ of tr(RᵀM) (Markley 1993, FOAM). λ is
  // the largest root of (λ² − |M|²)² = 8 λ det M + 4 |cof M|². Newton's method reaches it from above. The
  // quotient loses digits if another rotation is nearly as near; such maps are left to the singular value
  // decomposition.
  constexpr double least_quotient = 1e-2;  // relative to |M|³: the error is below 1e-12
  constexpr double last_change = 1e-9;     // relative: the error is about its square
  constexpr int most_steps = 20;
  const Eigen::Matrix3d cofactor = cofactors(map);
  const double determinant = map.col(0).dot(cofactor.col(0));
  const double square = map.squaredNorm(), size = std::sqrt(square);
  const double constant = 4 * cofactor.squaredNorm();
  double root = std::sqrt(3.0) * size;  // an upper bound
  for (int step = 0; step < most_steps; ++step) {
    const double excess = root * root - square;
    const double change =
        (excess * excess - 8 * determinant * root - constant) / (4 * excess * root - 8 * determinant);
    root -= change;
    if (!(std::abs(change) > last_change * root)) break;
  }
  const double half_excess = (root * root - square) / 2;
  const double quotient = half_excess * root - determinant;
  if (!(quotient > least_quotient * square * size)) return nearest_rotation_by_svd(map);
  const Eigen::Matrix3d inner = (half_excess + square) * Eigen::Matrix3d::Identity() - map.transpose() * map;
  return (map * inner + root * cofactor) / quotient;
}

bool polar_decompose(const Eigen::Matrix3d& map, PolarParts& parts) {
  constexpr double flattest = 1e-6, smallest = 1e-90;  // below `smallest`, volumes underflow
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(map, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Vector3d& sigma = svd.singularValues();
  if (!(sigma[2] > flattest * sigma[0]) || !(sigma[2] > smallest) || map.determinant() < 0) return false;
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
