#pragma once

#include <span>
#include <vector>

#include <Eigen/Core>

#include "linalg/sparse.h"

namespace meshgraft {

/// Returns functions of blend weights, rows × (columns × `degree`): for each column, polynomials of degree 1 to
/// `degree` that are 0 where the weight is 0 (Chebyshev polynomials over 0 … 1). A rotation that grows with a
/// weight is nearly a sum of them, even where it winds around several times between two centres: degree 14 is
/// within 0.001 up to two full turns.
Columns winding_functions(const Columns& weights, int degree);

/// Returns the matrix (functions × samples) that fits values at samples by functions with the given values
/// there (samples × functions). Least squares with weights per sample. `penalty` is empty or a positive
/// semidefinite matrix of the last functions: it adds cᵀ penalty c for their coefficients c. Combinations of
/// functions that both hardly see are left out.
Eigen::MatrixXd fit_functions(const Eigen::MatrixXd& at_samples, std::span<const double> sample_weights,
                              const Eigen::MatrixXd& penalty = {});

/// Returns Σ_v weight_v f_i(v) f_j(v) for functions with these values at vertices (vertices × functions).
Eigen::MatrixXd square_integrals(const Eigen::Ref<const Columns>& functions, const Eigen::VectorXd& weights);

}  // namespace meshgraft
