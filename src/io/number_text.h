#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

/// Why a piece of text is not a value of the type that was asked for.
enum class NumberFault { none, malformed, out_of_range };

struct ParsedNumber {
  double value = 0;
  NumberFault fault = NumberFault::none;
};

/// The number that `text` (all of it) writes, independent of any locale. "nan" and "inf" in their usual
/// spellings are numbers; a value too small to be told from zero is zero; for float32 the nearest float.
/// Integer types accept "255.0", but no fractions.
ParsedNumber parse_number(std::string_view text, ScalarType type);

/// Appends the shortest text that reads back as `value`, which must be a value of `type` (see `narrow`).
void append_number(std::string& text, double value, ScalarType type);

/// `value` rounded to the nearest value of `type`; `fault` is out_of_range where there is none.
ParsedNumber narrow(double value, ScalarType type);

/// The same value, bit for bit; any NaN equals any other.
bool same_value(double a, double b);

bool is_integer(ScalarType type);
std::size_t size_of(ScalarType type);

/// What is wrong with `text`, as the problem of an Error, and what to do about it.
std::string describe_fault(std::string_view text, ScalarType type, NumberFault fault);
std::string remedy_for(std::string_view text, NumberFault fault);

/// "line 12": the line (counting LF, CRLF and CR as one line end each) that `offset` is on.
std::string line_name(std::string_view content, std::size_t offset);

}  // namespace meshgraft::io
