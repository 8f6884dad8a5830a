#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <nlohmann/json.hpp>

namespace meshgraft::io {

/// Members in the order of the file.
using Json = nlohmann::ordered_json;

/// The JSON of a glTF file. Throws Error(input) with line or byte where it is malformed, is no object, or is
/// nested deeper than any glTF file has a use for.
Json parse_gltf_json(std::string_view text, const std::string& file);

/// `text`, which reads as `before`, changed as little as it takes to read as `after`: values that are equal
/// keep their bytes (number texts, blanks, order), new members and elements go behind the last one.
std::string patch_json_text(std::string_view text, const Json& before, const Json& after);

/// A value of a glTF file that knows its place, for messages like "bird.gltf: accessors[3].bufferView".
/// Members throw Error(input) where the file has something else than what is asked for.
class JsonView {
 public:
  JsonView(const Json& json, std::string location, const std::string& file)
      : json_(&json), location_(std::move(location)), file_(&file) {}

  const Json& json() const { return *json_; }
  const std::string& location() const { return location_; }
  const std::string& file() const { return *file_; }

  std::optional<JsonView> find(const std::string& key) const;
  JsonView at(const std::string& key) const;
  JsonView at(std::size_t element) const;

  /// Elements of the array `key`; 0 where there is none.
  std::size_t count(const std::string& key) const;
  std::size_t size() const;

  std::string text() const;
  double number() const;
  std::uint64_t whole() const;  ///< at most 2^53
  std::uint64_t whole(const std::string& key, std::uint64_t otherwise) const;
  bool flag(const std::string& key) const;

  /// An index into an array of `count` elements, which people call `what`.
  std::size_t index(std::size_t count, std::string_view what) const;

  [[noreturn]] void fail(const std::string& problem,
                         const std::string& remedy = "Correct the file, or export it again") const;

 private:
  const Json* json_;
  std::string location_;
  const std::string* file_;
};

}  // namespace meshgraft::io
