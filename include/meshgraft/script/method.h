#pragma once

#include <string_view>
#include <variant>
#include <vector>

#include <meshgraft/baselines/baselines.h>
#include <meshgraft/deform/deformer.h>

namespace meshgraft {

/// How an edit is solved: by one of this library's methods, or by a published one to compare with.
using Method = std::variant<DeformMethod, Baseline>;

/// "corotational", "arap-2007" and so on.
std::string_view to_string(const Method& value);

/// This library's methods, then the published ones.
std::vector<Method> all_methods();

/// The method of that name. Throws Error(usage), naming the known ones and the nearest, for any other name.
Method method_named(std::string_view name);

}  // namespace meshgraft
