#pragma once

#include <string_view>

#include <nlohmann/json.hpp>

#include <meshgraft/mesh/diagnostics.h>
#include <meshgraft/mesh/repair.h>

namespace meshgraft::cli {

/// Returns "vertex", "face" or "corner".
std::string_view domain_name(Domain domain);

/// Prints the findings of a check, a few lines each: name, severity, count, first indices, remedy. The first
/// finding follows `label`.
void print_findings(const Diagnostics& diagnostics, std::string_view label);

/// Returns the name, count, domain and description of a repair's change, for reports.
nlohmann::ordered_json change_json(const RepairChange& change);

}  // namespace meshgraft::cli
