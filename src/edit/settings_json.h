#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <meshgraft/edit/edit_file.h>

namespace meshgraft {

/// Settings as an edit file and a report write them: all of them, so that a changed default changes no old
/// edit.
nlohmann::ordered_json settings_json(const DeformSettings& settings);

/// "auto", "cholmod" or "eigen".
std::string backend_word(SolverBackend backend);

}  // namespace meshgraft
