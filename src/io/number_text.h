#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <string_view>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// The value of an attribute where a file has none.
inline constexpr double no_value = std::numeric_limits<double>::quiet_NaN();

/// The reason why a text is not a value of the requested type.
enum class NumberFault { none, malformed, out_of_range };

struct ParsedNumber {
  double value = 0;
  NumberFault fault = NumberFault::none;
};

/// Parses all of `text` as a number, independent of any locale. "nan" and "inf" in their usual spellings are
/// numbers. A value too small to be told from zero becomes zero. For float32 the result is the nearest float.
/// Integer types accept "255.0", but no fractions.
ParsedNumber parse_number(std::string_view text, ScalarType type);

/// Appends the shortest text that reads back as `value`, which must be a value of `type` (see `narrow`).
void append_number(std::string& text, double value, ScalarType type);

/// Returns `value` rounded to the nearest value of `type`. `fault` is out_of_range if there is none.
ParsedNumber narrow(double value, ScalarType type);

/// Returns whether two values are equal bit for bit. Any NaN equals any other.
bool same_value(double a, double b);

bool is_integer(ScalarType type);
std::size_t size_of(ScalarType type);

/// Returns the fact that `word` is no value of `type`: io.not_a_number, io.not_a_whole_number,
/// io.decimal_comma or io.number_out_of_range. It should be the `value` of an `element`, in the format's terms:
/// the "x" of a "vertex".
Fact bad_number(std::string_view element, std::string_view value, std::string_view word, ScalarType type,
                NumberFault fault);

/// Returns a word of a file for an Error: shortened, and without control characters.
std::string shown(std::string_view word);

/// Returns the line of `offset` as "line 12". LF, CRLF and CR each count as one line end.
std::string line_name(std::string_view content, std::size_t offset);

}  // namespace meshgraft::io
