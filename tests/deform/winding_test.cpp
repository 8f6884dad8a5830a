#include "deform/reduced/winding.h"

#include <cmath>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

namespace meshgraft {
namespace {

TEST(WindingFunctions, VanishAtWeightZero) {
  Columns weights(1, 2);
  weights << 0, 0.7;
  const Columns functions = winding_functions(weights, 5);
  EXPECT_EQ(functions.cols(), 10);
  EXPECT_TRUE(functions.leftCols(5).isZero(0));
  EXPECT_EQ(functions(0, 5), 2 * 0.7) << "the first is 2 w";
}

TEST(WindingFunctions, AreNearlyARotationThatWindsAroundTwice) {
  constexpr int samples = 200, degree = 14;
  Columns weights(samples, 1);
  Eigen::MatrixXd waves(samples, 2);
  for (int k = 0; k < samples; ++k) {
    weights(k, 0) = (k + 0.5) / samples;
    const double angle = 4 * std::numbers::pi * weights(k, 0);
    waves.row(k) << std::cos(angle) - 1, std::sin(angle);
  }
  const Columns functions = winding_functions(weights, degree);
  const Eigen::MatrixXd fit = fit_functions(functions, std::vector<double>(samples, 1.0));
  EXPECT_LT((functions * (fit * waves) - waves).cwiseAbs().maxCoeff(), 1e-3);
}

TEST(FitFunctions, FindsTheCoefficientsOfASum) {
  Eigen::MatrixXd functions(6, 2), coefficients(2, 3);
  functions << 1, 0, 1, 1, 1, 2, 1, 3, 1, 5, 1, 8;
  coefficients << 1, -2, 3, 0.5, 4, -1;
  const Eigen::MatrixXd fit = fit_functions(functions, std::vector<double>{1, 2, 0, 1, 3, 1});
  EXPECT_LT((fit * functions * coefficients - coefficients).cwiseAbs().maxCoeff(), 1e-12);
  EXPECT_TRUE(fit.col(2).isZero(1e-12)) << "a sample without weight";
}

TEST(FitFunctions, LeavesOutWhatNoSampleSees) {
  Eigen::MatrixXd functions = Eigen::MatrixXd::Zero(4, 2);
  functions.col(0) << 1, 2, 3, 4;
  const Eigen::MatrixXd fit = fit_functions(functions, std::vector<double>(4, 1.0));
  EXPECT_TRUE(fit.row(1).isZero(1e-12));
  EXPECT_NEAR((fit * functions.col(0))(0), 1, 1e-12);
}

}  // namespace
}  // namespace meshgraft
