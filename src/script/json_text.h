#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace meshgraft::json {

/// Formats a document for reading: values that fit on one line are not broken, and long lists of numbers fill
/// their lines. Numbers have the fewest digits that read back to the same bits; non-finite ones are null.
std::string to_text(const nlohmann::ordered_json& document);

}  // namespace meshgraft::json
