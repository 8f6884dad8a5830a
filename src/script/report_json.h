#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/script/report.h>

namespace meshgraft {

// Parts of a report, as specified in docs/report.md.
nlohmann::ordered_json counts_json(const DeformCounts& counts);
nlohmann::ordered_json quality_json(const Quality& quality);
/// Returns the name, count, domain and description of a change. The description is in the words of an
/// interface.
nlohmann::ordered_json change_json(const RepairChange& change, const Wording& wording);
nlohmann::ordered_json pin_json(const CutPin& pin);
nlohmann::ordered_json starts_json(const std::vector<StartCandidate>& starts);

}  // namespace meshgraft
