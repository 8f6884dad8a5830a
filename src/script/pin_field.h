#pragma once

#include <optional>
#include <string>
#include <string_view>

#include <meshgraft/core/error.h>

namespace meshgraft {

/// Returns the field of `pins` in an edit file that an error of a cut is about, such as "count" for
/// `pin_count`; nothing for an error about something else.
inline std::optional<std::string> pin_field(const Location& location) {
  constexpr std::string_view prefix = "pin_";
  const std::string name = location.text();
  if (!name.starts_with(prefix)) return std::nullopt;
  return name.substr(prefix.size());
}

}  // namespace meshgraft
