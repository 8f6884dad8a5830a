#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Core>

namespace meshgraft {

/// Returns a number in single precision, or 0 below 1e-18. The products of two such numbers are never denormal.
/// Processors multiply those many times more slowly.
inline float short_number(double number) { return std::abs(number) < 1e-18 ? 0 : static_cast<float>(number); }

/// Returns Σ_c value_c · coefficient_ck for k = 0, 1, 2. `values` has `lanes` numbers per column, and
/// `coefficients` three.
template <int lanes>
std::array<Eigen::Array<double, lanes, 1>, 3> sums_of_products(const float* values, const float* coefficients,
                                                               Eigen::Index columns) {
  using Lanes = Eigen::Array<float, lanes, 1>;
  constexpr Eigen::Index short_sum = 32;  // terms summed in single precision before rounding matters
  std::array<Eigen::Array<double, lanes, 1>, 3> sums;
  for (auto& sum : sums) sum.setZero();
  for (Eigen::Index first = 0; first < columns; first += short_sum) {
    Lanes x = Lanes::Zero(), y = Lanes::Zero(), z = Lanes::Zero();
    for (Eigen::Index c = first; c < std::min(columns, first + short_sum);
         ++c, values += lanes, coefficients += 3) {
      const Eigen::Map<const Lanes> column(values);
      x += column * coefficients[0];
      y += column * coefficients[1];
      z += column * coefficients[2];
    }
    sums[0] += x.template cast<double>();
    sums[1] += y.template cast<double>();
    sums[2] += z.template cast<double>();
  }
  return sums;
}

}  // namespace meshgraft
