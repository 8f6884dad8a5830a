#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include <meshgraft/baselines/baselines.h>
#include <meshgraft/deform/deformer.h>

namespace meshgraft {

/// The method that solves an edit: one of this library's methods, or a published one for comparison.
using Method = std::variant<DeformMethod, Baseline>;

/// Returns the name, such as "corotational" or "arap-2007".
std::string_view to_string(const Method& value);

/// Returns this library's methods, then the published ones.
std::vector<Method> all_methods();

/// Returns the method of that name. Throws Error(usage), listing the known names and the nearest one, for any
/// other name.
Method method_named(std::string_view name);

}  // namespace meshgraft
