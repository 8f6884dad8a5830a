#pragma once

#include <string_view>

#include <meshgraft/mesh/diagnostics.h>

namespace meshgraft::cli {

/// Prints what the check found, a few lines each, the first one after `label`: name, severity, count, first
/// indices, remedy.
void print_findings(const Diagnostics& diagnostics, std::string_view label);

/// "vertex", "face" or "corner".
std::string_view domain_name(Domain domain);

}  // namespace meshgraft::cli
