#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>

namespace meshgraft {

// Facts in reports and in the editor's messages, as specified in docs/report.md.

/// Returns {"id", "fields": {name: value}, "text"}. The text is in the words of an interface, and ends with the
/// remedy, if there is one.
nlohmann::ordered_json to_json(const Fact& fact, const Wording& wording = library_text);

/// Returns a list of them.
nlohmann::ordered_json to_json(std::span<const Note> notes, const Wording& wording = library_text);

/// Returns {"id", "code", "location", "fields", "problem", "remedy", "notes"}.
nlohmann::ordered_json to_json(const Error& error, const Wording& wording = library_text);

}  // namespace meshgraft
