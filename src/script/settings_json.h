#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <meshgraft/script/edit_file.h>

namespace meshgraft {

/// Settings as an edit file and a report write them: all of them, so that a changed default changes no old
/// edit.
nlohmann::ordered_json settings_json(const DeformSettings& settings);

nlohmann::ordered_json settings_json(const MergeSettings& settings);

/// "find" or "keep".
std::string pose_word(MergePose pose);

/// "similar" or "ft05".
std::string shape_word(MergeShape shape);

/// "auto", "multifrontal", "eigen" or "iterative".
std::string backend_word(SolverBackend backend);

}  // namespace meshgraft
