#pragma once

#include <span>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns the attribute on new elements. Values are mixed by its interpolation rule, and integer types are
/// rounded. Mixtures with a missing value (NaN) are missing; an element with from = -1 has no value.
Attribute interpolate_attribute(const Attribute& attribute, std::span<const EdgePoint> elements);

/// Returns the value as an attribute of this type has it: integer types are rounded.
double representable(double value, ScalarType type);

}  // namespace meshgraft
