// Results that must never change.
#pragma once

#include <gtest/gtest.h>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// The mean of all positions, and their root mean square with the weights 1, 2, 3 … along the order of the
/// vertices.
struct Pin {
  Eigen::RowVector3d mean, weighted;
};

inline Pin pin_of(const Points& positions) {
  const Eigen::VectorXd weights =
      Eigen::VectorXd::LinSpaced(positions.rows(), 1, static_cast<double>(positions.rows()));
  return {positions.colwise().mean(),
          ((weights.transpose() * positions.array().square().matrix()) / weights.sum()).cwiseSqrt()};
}

inline void expect_pin(const Points& positions, const Pin& expected) {
  const Pin pin = pin_of(positions);
  EXPECT_LT((pin.mean - expected.mean).norm(), 1e-9) << pin.mean.format(Eigen::IOFormat(17));
  EXPECT_LT((pin.weighted - expected.weighted).norm(), 1e-9) << pin.weighted.format(Eigen::IOFormat(17));
}

}  // namespace meshgraft::test
