#include "winding.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Eigenvalues>
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

Eigen::MatrixXd fit_functions(const Eigen::MatrixXd& at_samples, std::span<const double> sample_weights,
                              const Eigen::MatrixXd& penalty) {
  constexpr double hardly = 1e-4;  // × the largest singular value
  const Eigen::Index samples = at_samples.rows(), functions = at_samples.cols();
  if (functions == 0) return Eigen::MatrixXd::Zero(0, samples);
  const Eigen::VectorXd roots = Eigen::Map<const Eigen::VectorXd>(sample_weights.data(), samples).cwiseSqrt();
  Eigen::MatrixXd rows(samples + penalty.rows(), functions);
  rows.topRows(samples) = roots.asDiagonal() * at_samples;
  if (penalty.rows() > 0) {
    const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(penalty);
    rows.bottomRows(penalty.rows()) << Eigen::MatrixXd::Zero(penalty.rows(), functions - penalty.rows()),
        eigen.eigenvalues().cwiseMax(0).cwiseSqrt().asDiagonal() * eigen.eigenvectors().transpose();
  }
  const Eigen::BDCSVD<Eigen::MatrixXd> svd(rows, Eigen::ComputeThinU | Eigen::ComputeThinV);
  const Eigen::VectorXd& values = svd.singularValues();
  const double least = hardly * values[0];
  const Eigen::VectorXd inverse =
      values.unaryExpr([least](double value) { return value > least ? 1 / value : 0; });
  return svd.matrixV() * inverse.asDiagonal() * svd.matrixU().topRows(samples).transpose() * roots.asDiagonal();
}

Eigen::MatrixXd square_integrals(const Eigen::Ref<const Columns>& functions, const Eigen::VectorXd& weights) {
  return functions.transpose() * weights.asDiagonal() * functions;
}

}  // namespace meshgraft
