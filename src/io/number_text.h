#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

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

/// Whether two values are equal bit for bit. Any NaN equals any other.
bool same_value(double a, double b);

bool is_integer(ScalarType type);
std::size_t size_of(ScalarType type);

/// Return the problem with `text` and the remedy, for an Error.
std::string describe_fault(std::string_view text, ScalarType type, NumberFault fault);
std::string remedy_for(std::string_view text, NumberFault fault);

/// Returns the line of `offset` as "line 12". LF, CRLF and CR each count as one line end.
std::string line_name(std::string_view content, std::size_t offset);

}  // namespace meshgraft::io
