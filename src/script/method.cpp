#include <meshgraft/script/report.h>

#include <string>

#include <meshgraft/core/error.h>

#include "baselines/baselines.h"

#include "compare.h"
#include "json_value.h"
#include "script/facts.h"

namespace meshgraft {

namespace {

template <class Named>
Named named(std::string_view name, const std::vector<Named>& all) {
  std::vector<std::string> names;
  for (const Named& candidate : all) {
    if (to_string(candidate) == name) return candidate;
    names.emplace_back(to_string(candidate));
  }
  if (const auto meant = json::nearest_name(name, names))
    throw Error(facts::script::MisspeltMethod{.name = name, .meant = *meant, .known = names});
  throw Error(facts::script::NoSuchMethod{.name = name, .known = names});
}

}  // namespace

std::string_view to_string(const Method& value) {
  return std::visit([](const auto& method) { return to_string(method); }, value);
}

std::vector<Method> all_methods() {
  std::vector<Method> methods{DeformMethod::corotational, DeformMethod::rotation_aware, DeformMethod::ft05,
                              DeformMethod::shell};
  for (const Baseline baseline : all_baselines) methods.emplace_back(baseline);
  return methods;
}

Method method_named(std::string_view name) { return named(name, all_methods()); }

std::string_view to_string(const Contender& value) {
  return std::visit([](const auto& contender) { return to_string(contender); }, value);
}

std::vector<Contender> all_contenders() {
  std::vector<Contender> contenders{DeformMethod::corotational, DeformMethod::rotation_aware,
                                    DeformMethod::ft05, DeformMethod::shell, Preset::as_published};
  for (const Baseline baseline : all_baselines) contenders.emplace_back(baseline);
  return contenders;
}

Contender contender_named(std::string_view name) { return named(name, all_contenders()); }

}  // namespace meshgraft
