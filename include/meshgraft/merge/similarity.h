#pragma once

#include <Eigen/Core>

namespace meshgraft {

/// A similarity x ↦ scale · rotation · x + translation.
struct Similarity {
  double scale = 1;
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
};

}  // namespace meshgraft
