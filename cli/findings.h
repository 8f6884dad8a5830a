#pragma once

#include <string_view>

#include <meshgraft/mesh/diagnostics.h>

namespace meshgraft::cli {

/// Prints the findings of a check, a few lines each: name, severity, count, first indices, remedy. The first
/// finding follows `label`.
void print_findings(const Diagnostics& diagnostics, std::string_view label);

/// Returns "vertex", "face" or "corner".
std::string_view domain_name(Domain domain);

}  // namespace meshgraft::cli
