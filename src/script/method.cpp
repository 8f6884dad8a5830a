#include <meshgraft/script/method.h>

#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <meshgraft/core/error.h>

#include "json_value.h"

namespace meshgraft {

std::string_view to_string(const Method& value) {
  return std::visit([](const auto& method) { return to_string(method); }, value);
}

std::vector<Method> all_methods() {
  std::vector<Method> methods{DeformMethod::corotational, DeformMethod::rotation_aware, DeformMethod::ft05};
  for (const Baseline baseline : all_baselines) methods.emplace_back(baseline);
  return methods;
}

Method method_named(std::string_view name) {
  std::vector<std::string> names;
  for (const Method& method : all_methods()) {
    if (to_string(method) == name) return method;
    names.emplace_back(to_string(method));
  }
  std::string remedy = fmt::format("Known are {}.", fmt::join(names, ", "));
  if (const auto meant = json::nearest_name(name, names))
    remedy = fmt::format("Did you mean '{}'? {}", *meant, remedy);
  throw Error(ErrorCode::usage, fmt::format("there is no method named '{}'", name), "", remedy);
}

}  // namespace meshgraft
