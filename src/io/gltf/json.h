#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>

#include "core/memory_budget.h"

namespace meshgraft::io {

/// JSON that keeps its members in the order of the file.
using Json = nlohmann::ordered_json;

/// Parses the JSON of a glTF file. Throws Error(input) with line or byte if it is malformed, is not an
/// object, or is nested deeper than any glTF file needs. `budget`, which may be null, is charged for the values
/// before they are made.
Json parse_gltf_json(std::string_view text, const std::string& file, MemoryBudget* budget = nullptr);

/// Returns `text`, which reads as `before`, with the fewest changes so that it reads as `after`. Equal values
/// keep their bytes (number texts, blanks, order). New members and elements follow the last one.
std::string patch_json_text(std::string_view text, const Json& before, const Json& after);

/// A value of a glTF file that knows its location, for messages like "bird.gltf: accessors[3].bufferView".
/// The member functions throw Error(input) if the value is missing or has another type than requested.
class JsonView {
 public:
  JsonView(const Json& json, std::string path, const std::string& file)
      : json_(&json), path_(std::move(path)), file_(&file) {}

  const Json& json() const { return *json_; }
  const std::string& path() const { return path_; }
  const std::string& file() const { return *file_; }

  std::optional<JsonView> find(const std::string& key) const;
  JsonView at(const std::string& key) const;
  JsonView at(std::size_t element) const;

  /// Returns the number of elements of the array `key`, or 0 if there is none.
  std::size_t count(const std::string& key) const;
  std::size_t size() const;

  std::string text() const;
  double number() const;
  std::uint64_t whole() const;  ///< at most 2^53
  std::uint64_t whole(const std::string& key, std::uint64_t otherwise) const;
  bool flag(const std::string& key) const;

  /// Returns the value as an index into an array of `count` elements. `what` names the array in messages.
  std::size_t index(std::size_t count, std::string_view what) const;

  /// Throws an Error at this value's location.
  [[noreturn]] void fail(const Fact& fact) const;

 private:
  const Json* json_;
  std::string path_;
  const std::string* file_;
};

}  // namespace meshgraft::io
