#include <meshgraft/script/report.h>

#include <string>

#include <meshgraft/core/error.h>

#include "baselines/baselines.h"

#include "json_value.h"
#include "script/facts.h"

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
  if (const auto meant = json::nearest_name(name, names))
    throw Error(facts::script::MisspeltMethod{.name = name, .meant = *meant, .known = names});
  throw Error(facts::script::NoSuchMethod{.name = name, .known = names});
}

}  // namespace meshgraft
