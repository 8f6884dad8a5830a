#pragma once

#include <span>

#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/core/fact.h>

namespace meshgraft {

// Facts in reports and in the editor's messages, as specified in docs/report.md.

/// Returns {"id", "fields": {name: value}, "text"}. The text ends with the remedy, if there is one.
nlohmann::ordered_json to_json(const Fact& fact);

/// Returns a list of them.
nlohmann::ordered_json to_json(std::span<const Note> notes);

/// Returns {"id", "code", "location", "fields", "problem", "remedy", "notes"}.
nlohmann::ordered_json to_json(const Error& error);

}  // namespace meshgraft
