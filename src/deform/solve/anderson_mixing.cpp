#include "anderson_mixing.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <Eigen/Cholesky>

namespace meshgraft {

namespace {

constexpr std::size_t most_changes = 5;

/// Returns the bound of the weights' norm. It leaves room to damp steps that swing. Iterates extrapolate
/// farther only where residuals fall: elsewhere, those of two nearly equal problems would soon differ.
double most_weight(double residual, double last_residual) {
  return std::max(1.0, std::pow(last_residual / residual, 6));
}

/// Returns γ that makes ‖f − Σ γ_k Δf_k‖ small, from the products of the Δf and those with f. The changes of
/// the residual can be nearly parallel, so the diagonal is made slightly larger.
Eigen::VectorXd mixing_weights(const Eigen::MatrixXd& products, const Eigen::VectorXd& with_residual) {
  constexpr double ridge = 1e-8;
  Eigen::VectorXd scale = products.diagonal().cwiseSqrt();
  scale = (scale.array() > 0).select(scale.cwiseInverse(), 0);
  Eigen::MatrixXd scaled = scale.asDiagonal() * products * scale.asDiagonal();
  scaled.diagonal().array() += ridge;
  return scale.cwiseProduct(scaled.ldlt().solve(scale.cwiseProduct(with_residual)));
}

}  // namespace

Columns AndersonMixing::next(const Columns& current, const Columns& step) {
  const double norm = std::sqrt(product_(step, step));
  if (residual_.rows() > 0) {
    Change change;
    if (changes_.size() == most_changes) {  // the memory of the oldest serves the newest
      change = std::move(changes_.back());
      changes_.pop_back();
    }
    change.residual = step - residual_;
    change.sum = current - iterate_ + change.residual;
    changes_.push_front(std::move(change));
  }
  const double last_norm = std::exchange(residual_norm_, norm);
  iterate_ = current;
  residual_ = step;

  const auto count = static_cast<Eigen::Index>(changes_.size());
  Eigen::MatrixXd products(count, count);
  Eigen::VectorXd with_residual(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    with_residual[k] = product_(changes_[k].residual, step);
    products(k, 0) = products(0, k) = product_(changes_[k].residual, changes_[0].residual);
  }
  if (count > 1)
    products.bottomRightCorner(count - 1, count - 1) = products_.topLeftCorner(count - 1, count - 1);
  products_ = products;
  Eigen::VectorXd weights = mixing_weights(products, with_residual);
  const double size = weights.norm(), most = most_weight(norm, last_norm);
  if (size > most) weights *= most / size;
  Columns mixed = current + step;
  for (Eigen::Index k = 0; k < count; ++k) mixed -= weights[k] * changes_[k].sum;
  return mixed;
}

}  // namespace meshgraft
