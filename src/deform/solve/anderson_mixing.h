#pragma once

#include <deque>
#include <functional>
#include <utility>

#include <Eigen/Core>

#include "linalg/sparse.h"

namespace meshgraft {

/// Accelerates a fixed-point iteration x ← x + f(x) by Anderson mixing (Walker and Ni 2011, "Anderson
/// acceleration for fixed-point iterations", algorithm AA, without damping). Let x̄ be the affine combination of
/// the last iterates whose residual f̄, the same combination of theirs, is the smallest. The next iterate is
/// x̄ + f̄. Where residuals hardly fall, x̄ stays close to the last iterate.
class AndersonMixing {
 public:
  /// Returns the inner product of two iterates. The result of an iteration is reproducible if this is.
  using Product = std::function<double(const Columns&, const Columns&)>;

  explicit AndersonMixing(Product product) : product_(std::move(product)) {}

  /// Returns the iterate after `current`, whose residual is `step` = f(current).
  Columns next(const Columns& current, const Columns& step);

 private:
  /// The change from one iterate to the next: of the iterate and its residual together, and of the residual.
  struct Change {
    Columns sum, residual;
  };

  Product product_;
  Columns iterate_, residual_;  ///< the last ones; without rows before the first call
  double residual_norm_ = 0;
  std::deque<Change> changes_;  ///< the newest first
  Eigen::MatrixXd products_;    ///< of the changes' residuals, kept for the next step
};

}  // namespace meshgraft
