#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace meshgraft {

/// Returns the matrix [v]× of the cross product: [v]× w = v × w.
inline Eigen::Matrix3d cross_matrix(const Eigen::Vector3d& v) {
  Eigen::Matrix3d matrix;
  matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return matrix;
}

/// Returns the rotation vector (axis × angle, radians) of a rotation, with an angle of at most π.
Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation);

/// Returns the rotation of a rotation vector.
Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& vector);

/// Returns J with exp(v)ᵀ d exp(v) = [J dv]×: the right Jacobian of the exponential map.
Eigen::Matrix3d right_jacobian(const Eigen::Vector3d& vector);

/// Returns the rotation vector nearest to `other` among those of the same rotation as `vector`.
Eigen::Vector3d nearest_turn(const Eigen::Vector3d& vector, const Eigen::Vector3d& other);

/// Returns the rotation (det +1) nearest to `map` in the Frobenius norm.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& map);

/// The factors of `map` = rotation · stretch, where the stretch is symmetric positive definite.
struct PolarParts {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(), stretch = Eigen::Matrix3d::Identity();
};

/// Returns false for reflections and for maps that (nearly) flatten space, which have no logarithm.
bool polar_decompose(const Eigen::Matrix3d& map, PolarParts& parts);

/// Return the logarithm of a symmetric positive definite matrix, and its inverse; xx, yy, zz, yz, zx, xy.
Eigen::Matrix<double, 6, 1> stretch_log(const Eigen::Matrix3d& stretch);
Eigen::Matrix3d stretch_exp(const Eigen::Matrix<double, 6, 1>& log);

}  // namespace meshgraft
