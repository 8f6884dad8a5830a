#include "findings.h"

#include <algorithm>
#include <string>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "script/report_json.h"
#include "wording.h"

namespace meshgraft::cli {

namespace {

std::string_view severity_name(Severity severity) {
  switch (severity) {
    case Severity::info: return "info";
    case Severity::worked_around: return "worked around in the solve";
    case Severity::refused: return "refused";
  }
  return "";
}

std::string first_of(const std::vector<Index>& indices) {
  constexpr std::size_t limit = 8;
  const auto shown = static_cast<std::ptrdiff_t>(std::min(limit, indices.size()));
  return fmt::format("{}{}", fmt::join(indices.begin(), indices.begin() + shown, ", "),
                     indices.size() > limit ? ", …" : "");
}

}  // namespace

std::string_view domain_name(Domain domain) {
  switch (domain) {
    case Domain::vertex: return "vertex";
    case Domain::face: return "face";
    case Domain::corner: return "corner";
  }
  return "";
}

void print_findings(const Diagnostics& diagnostics, std::string_view label) {
  const auto line = [](std::string_view before, const std::string& text) {
    fmt::print("  {:<12}{}\n", before, text);
  };
  if (diagnostics.clean()) line(label, "none");
  for (const Finding& finding : diagnostics.findings) {
    const FactText text = text_of(finding.note);
    line(label,
         fmt::format("{} ({}): {}", name_of(finding.kind), severity_name(finding.severity), text.statement));
    line("", fmt::format("  at {} {}", domain_name(finding.domain), first_of(finding.indices)));
    if (!text.remedy.empty()) line("", "  " + text.remedy);
    label = "";
  }
}

nlohmann::ordered_json change_json(const RepairChange& change) {
  return meshgraft::change_json(change, text_of);
}

}  // namespace meshgraft::cli
