#pragma once

#include <string_view>

#include <meshgraft/mesh/triage.h>

namespace meshgraft::cli {

/// Prints what triage found, a few lines each, the first one after `label`: name, severity, count, first
/// indices, remedy.
void print_findings(const TriageReport& triage, std::string_view label);

/// "vertex", "face" or "corner".
std::string_view domain_name(Domain domain);

}  // namespace meshgraft::cli
