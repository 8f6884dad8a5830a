#include "winding.h"

#include <algorithm>
#include <cmath>

#include <Eigen/SVD>

namespace meshgraft {

Columns winding_functions(const Columns& weights, int degree) {
  Columns functions(weights.rows(), weights.cols() * degree);
  for (Eigen::Index row = 0; row < weights.rows(); ++row)
    for (Eigen::Index column = 0; column < weights.cols(); ++column) {
      const double t = 2 * weights(row, column) - 1;
      double before = 1, now = t;
      for (int m = 1; m <= degree; ++m) {
        const double at_zero = m % 2 == 0 ? 1 : -1;
        functions(row, column * degree + m - 1) = now - at_zero;
        const double next = 2 * t * now - before;
        before = now;
        now = next;
      }
    }
  return functions;
}

Eigen::MatrixXd fit_functions(const Eigen::MatrixXd& at_samples, std::span<const double> sample_weights) {
  constexpr double hardly = 1e-4;  // × the largest singular value
  if (at_samples.cols() == 0) return Eigen::MatrixXd::Zero(0, at_samples.rows());
  const Eigen::VectorXd roots =
      Eigen::Map<const Eigen::VectorXd>(sample_weights.data(), at_samples.rows()).cwiseSqrt();
  Eigen::BDCSVD<Eigen::MatrixXd> svd(roots.asDiagonal() * at_samples,
                                     Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  const double least = hardly * values[0];
  const Eigen::VectorXd inverse =
      values.unaryExpr([least](double value) { return value > least ? 1 / value : 0; });
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().transpose() * roots.asDiagonal();
}

}  // namespace meshgraft
