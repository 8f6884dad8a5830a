#include "number_text.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cctype>
#include <charconv>
#include <cmath>
#include <limits>

#include "io/facts.h"

namespace meshgraft::io {

namespace {

struct Range {
  double low;
  double high;
};

Range range_of(ScalarType type) {
  switch (type) {
    case ScalarType::int8: return {-128, 127};
    case ScalarType::uint8: return {0, 255};
    case ScalarType::int16: return {-32768, 32767};
    case ScalarType::uint16: return {0, 65535};
    case ScalarType::int32: return {-2147483648.0, 2147483647.0};
    case ScalarType::uint32: return {0, 4294967295.0};
    case ScalarType::float32:
      return {-double{std::numeric_limits<float>::max()}, std::numeric_limits<float>::max()};
    case ScalarType::float64: break;
  }
  return {-std::numeric_limits<double>::max(), std::numeric_limits<double>::max()};
}

bool spells_infinity(std::string_view text) { return text.find_first_of("iI") != std::string_view::npos; }

/// Parses the spellings of Microsoft's older C library: 1.#INF, -1.#IND, 1.#QNAN, 1.#SNAN.
ParsedNumber parse_legacy_special(std::string_view text) {
  const bool negative = text.starts_with('-');
  const std::string_view special = text.substr(negative ? 1 : 0);
  if (special.starts_with("1.#INF")) {
    const double infinity = std::numeric_limits<double>::infinity();
    return {negative ? -infinity : infinity, NumberFault::none};
  }
  if (special.starts_with("1.#IND") || special.starts_with("1.#QNAN") || special.starts_with("1.#SNAN")) {
    return {std::numeric_limits<double>::quiet_NaN(), NumberFault::none};
  }
  return {0, NumberFault::malformed};
}

/// Returns whether a text that the parser found out of range is too small rather than too large.
bool is_tiny(std::string_view text) {
  const std::size_t exponent = text.find_first_of("eE");
  if (exponent != std::string_view::npos) return text.substr(exponent + 1).starts_with('-');
  return text.starts_with("0.") || text.starts_with("-0.") || text.starts_with('.') || text.starts_with("-.");
}

template <class Real>
ParsedNumber parse_real(std::string_view text) {
  Real value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (end != text.data() + text.size() || error == std::errc::invalid_argument)
    return parse_legacy_special(text);
  if (error == std::errc::result_out_of_range && is_tiny(text)) return {0, NumberFault::none};
  const bool overflow =
      error == std::errc::result_out_of_range || (std::isinf(value) && !spells_infinity(text));
  return {value, overflow ? NumberFault::out_of_range : NumberFault::none};
}

}  // namespace

ParsedNumber parse_number(std::string_view text, ScalarType type) {
  // from_chars accepts no plus sign, but files contain it.
  if (text.size() > 1 && text[0] == '+' && text[1] != '-' && text[1] != '+') text.remove_prefix(1);
  if (type == ScalarType::float32) return parse_real<float>(text);
  if (type == ScalarType::float64) return parse_real<double>(text);

  std::int64_t integer = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), integer);
  double value = static_cast<double>(integer);
  if (end != text.data() + text.size() || error != std::errc{}) {
    const ParsedNumber real = parse_real<double>(text);
    if (real.fault != NumberFault::none) return real;
    if (real.value != std::trunc(real.value)) return {0, NumberFault::malformed};
    value = real.value;
  }
  const auto [low, high] = range_of(type);
  if (value < low || value > high) return {value, NumberFault::out_of_range};
  return {value, NumberFault::none};
}

void append_number(std::string& text, double value, ScalarType type) {
  std::array<char, 32> buffer;
  char* const end = buffer.data() + buffer.size();
  if (std::isnan(value)) {
    text += "nan";
  } else if (type == ScalarType::float64) {
    text.append(buffer.data(), std::to_chars(buffer.data(), end, value).ptr);
  } else if (type == ScalarType::float32) {
    text.append(buffer.data(), std::to_chars(buffer.data(), end, static_cast<float>(value)).ptr);
  } else {
    text.append(buffer.data(), std::to_chars(buffer.data(), end, static_cast<std::int64_t>(value)).ptr);
  }
}

ParsedNumber narrow(double value, ScalarType type) {
  if (type == ScalarType::float64) return {value, NumberFault::none};
  if (type == ScalarType::float32) {
    if (!std::isfinite(value)) return {value, NumberFault::none};
    const float rounded = static_cast<float>(value);
    return {rounded, std::isinf(rounded) ? NumberFault::out_of_range : NumberFault::none};
  }
  const double rounded = std::nearbyint(value);
  const auto [low, high] = range_of(type);
  if (!(rounded >= low && rounded <= high)) return {value, NumberFault::out_of_range};
  return {rounded, NumberFault::none};
}

bool same_value(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b) || (std::isnan(a) && std::isnan(b));
}

bool is_integer(ScalarType type) { return type != ScalarType::float32 && type != ScalarType::float64; }

std::size_t size_of(ScalarType type) {
  switch (type) {
    case ScalarType::int8:
    case ScalarType::uint8: return 1;
    case ScalarType::int16:
    case ScalarType::uint16: return 2;
    case ScalarType::int32:
    case ScalarType::uint32:
    case ScalarType::float32: return 4;
    case ScalarType::float64: break;
  }
  return 8;
}

Fact bad_number(std::string_view element, std::string_view value, std::string_view word, ScalarType type,
                NumberFault fault) {
  if (fault == NumberFault::out_of_range)
    return facts::io::NumberOutOfRange{.element = element, .value = value, .word = shown(word)};
  if (word.find(',') != std::string_view::npos)
    return facts::io::DecimalComma{.element = element, .value = value, .word = shown(word)};
  if (is_integer(type))
    return facts::io::NotAWholeNumber{.element = element, .value = value, .word = shown(word)};
  return facts::io::NotANumber{.element = element, .value = value, .word = shown(word)};
}

std::string shown(std::string_view word) {
  constexpr std::size_t longest = 40;
  std::string text(word.substr(0, longest));
  std::ranges::replace_if(text, [](unsigned char c) { return c < 32 || c == 127; }, '?');
  return word.size() > longest ? text + "…" : text;
}

std::string line_name(std::string_view content, std::size_t offset) {
  std::size_t line = 1;
  const std::size_t end = std::min(offset, content.size());
  for (std::size_t i = 0; i < end; ++i) {
    const bool lone_cr = content[i] == '\r' && (i + 1 >= content.size() || content[i + 1] != '\n');
    if (content[i] == '\n' || lone_cr) ++line;
  }
  return "line " + std::to_string(line);
}

}  // namespace meshgraft::io
