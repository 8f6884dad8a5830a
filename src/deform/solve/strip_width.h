#pragma once

#include <cmath>
#include <optional>

namespace meshgraft {

/// Returns the width of a strip whose mean sag under a uniform unit load is `sag`, if it is clamped at both
/// sides and has tension 1 and bending stiffness t² (Euler–Bernoulli beam), or no tension and bending stiffness
/// 1.
inline double strip_width(double sag, std::optional<double> t) {
  if (!t) return std::pow(720 * sag, 0.25);
  if (!(sag > 0)) return 0;
  const auto sag_of = [&](double width) {
    const double x = width / *t;
    if (x < 0.1) return width * width * x * x / 720;  // the closed form loses its digits
    return width * width / 12 - width * *t / 2 / std::tanh(x / 2) + *t * *t;
  };
  double low = 0, high = std::sqrt(12 * sag) + 12 * *t;
  while (sag_of(high) < sag) high *= 2;
  for (int step = 0; step < 60; ++step) (sag_of((low + high) / 2) < sag ? low : high) = (low + high) / 2;
  return high;
}

}  // namespace meshgraft
