#pragma once

#include <string>

#include <nlohmann/json.hpp>

namespace meshgraft::json {

/// A document as people like to read it: what fits on a line stands on one, long lists of numbers fill lines.
/// Numbers have the fewest digits that read back to the same bits; non-finite ones are null.
std::string to_text(const nlohmann::ordered_json& document);

}  // namespace meshgraft::json
