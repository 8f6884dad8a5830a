#include "interpolate_attribute.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace meshgraft {

namespace {

void append(const Attribute& attribute, const EdgePoint& element, std::vector<double>& out) {
  const auto count = static_cast<std::size_t>(attribute.components);
  if (element.from < 0) {
    out.insert(out.end(), count, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  const double* a = attribute.values.data() + element.from * count;
  const double* b = attribute.values.data() + element.to * count;
  if (element.t == 0 || element.from == element.to) {
    out.insert(out.end(), a, a + count);
    return;
  }
  if (attribute.interpolation == Interpolation::nearest) {
    const double* near = element.t <= 0.5 ? a : b;
    out.insert(out.end(), near, near + count);
    return;
  }
  const std::size_t first = out.size();
  for (std::size_t k = 0; k < count; ++k) out.push_back((1 - element.t) * a[k] + element.t * b[k]);
  const bool is_missing = std::any_of(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
                                      [](double value) { return std::isnan(value); });
  if (attribute.interpolation == Interpolation::direction && is_missing) {
    std::fill(out.begin() + static_cast<std::ptrdiff_t>(first), out.end(),
              std::numeric_limits<double>::quiet_NaN());
  } else if (attribute.interpolation == Interpolation::direction) {
    Eigen::Map<Eigen::VectorXd> direction(out.data() + first, attribute.components);
    const double length = direction.stableNorm();
    if (length > 0) {
      direction /= length;
    } else {
      std::copy_n(element.t <= 0.5 ? a : b, count, direction.data());  // opposite directions have no middle
    }
  }
  for (std::size_t k = first; k < out.size(); ++k) out[k] = representable(out[k], attribute.type);
}

}  // namespace

double representable(double value, ScalarType type) {
  return type == ScalarType::float32 || type == ScalarType::float64 ? value : std::round(value);
}

Attribute interpolate_attribute(const Attribute& attribute, std::span<const EdgePoint> elements) {
  Attribute result = attribute;
  result.values.clear();
  result.values.reserve(elements.size() * attribute.components);
  for (const EdgePoint& element : elements) append(attribute, element, result.values);
  return result;
}

}  // namespace meshgraft
