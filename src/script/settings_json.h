#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <meshgraft/script/edit_file.h>

namespace meshgraft {

/// Returns settings as an edit file and a report write them. All are written, so that a changed default
/// changes no old edit.
nlohmann::ordered_json settings_json(const DeformSettings& settings);

nlohmann::ordered_json settings_json(const MergeSettings& settings);

nlohmann::ordered_json settings_json(const RepairOptions& options);

/// Returns "find" or "keep".
std::string pose_word(MergePose pose);

/// Returns "similar" or "ft05".
std::string shape_word(MergeShape shape);

}  // namespace meshgraft
