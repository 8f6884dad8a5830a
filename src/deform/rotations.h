#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace meshgraft {

/// Rotation vector (axis × angle, radians) of a rotation, of at most half a turn.
Eigen::Vector3d rotation_log(const Eigen::Matrix3d& rotation);

/// The rotation of a rotation vector.
Eigen::Matrix3d rotation_exp(const Eigen::Vector3d& vector);

/// Of all rotation vectors that mean the same rotation as `vector`, the one nearest to `other`.
Eigen::Vector3d nearest_turn(const Eigen::Vector3d& vector, const Eigen::Vector3d& other);

/// The rotation (det +1) nearest to `map` in the Frobenius norm.
Eigen::Matrix3d nearest_rotation(const Eigen::Matrix3d& map);

/// `map` = rotation · stretch, the stretch symmetric positive definite.
struct PolarParts {
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity(), stretch = Eigen::Matrix3d::Identity();
};

/// False for reflections and for maps that flatten space (nearly), which have no logarithm.
bool polar_decompose(const Eigen::Matrix3d& map, PolarParts& parts);

/// Logarithm of a symmetric positive definite matrix, and its inverse; xx, yy, zz, yz, zx, xy.
Eigen::Matrix<double, 6, 1> stretch_log(const Eigen::Matrix3d& stretch);
Eigen::Matrix3d stretch_exp(const Eigen::Matrix<double, 6, 1>& log);

}  // namespace meshgraft
