#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace meshgraft {

/// Returns the beginning of a UTF-8 text, at most `most_bytes` long, without splitting a character.
inline std::string whole_characters(std::string_view text, std::size_t most_bytes) {
  if (text.size() <= most_bytes) return std::string(text);
  const auto continues = [&](std::size_t at) {
    return (static_cast<unsigned char>(text[at]) & 0xC0U) == 0x80U;
  };
  while (most_bytes > 0 && continues(most_bytes)) --most_bytes;
  return std::string(text.substr(0, most_bytes));
}

/// Returns whether a text is UTF-8, judged only by the lengths of its characters.
inline bool is_utf8(std::string_view text) {
  std::size_t missing = 0;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    const bool continues = (byte & 0xC0U) == 0x80U;
    if (continues != (missing > 0)) return false;
    if (continues)
      --missing;
    else if (byte >= 0xF8U)
      return false;
    else
      missing = byte >= 0xF0U ? 3 : byte >= 0xE0U ? 2 : byte >= 0xC0U ? 1 : 0;
  }
  return missing == 0;
}

}  // namespace meshgraft
