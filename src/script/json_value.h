#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

#include "script/facts.h"

namespace meshgraft::json {

using Json = nlohmann::json;

/// Parses a document. Throws Error(input): with line and column for malformed text (script.not_json), also for
/// a repeated key and for nesting deeper than `depth_limit`.
Json parse(std::string_view text, const Location& location, int depth_limit);

/// Returns the candidate that is most similar to `name`, or nothing if none is similar.
std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates);

/// A JSON value that knows its path in the document, so that every error message can name it. Paths are only
/// assembled when they are asked for. A value must not outlive the one it was taken from.
class Value {
 public:
  Value(const Json& root, const std::string& document) : json_(&root), document_(&document) {}

  /// Returns "edit.json: steps[0].mesh", or "edit.json" for the root.
  Location location() const;
  /// Throws this error at the value's location.
  [[noreturn]] void fail(const Fact& fact) const;
  /// Fails with script.wrong_type.
  [[noreturn]] void fail_type(facts::script::Type expected) const;

  const Json& raw() const { return *json_; }
  bool is_object() const { return json_->is_object(); }
  bool is_array() const { return json_->is_array(); }
  bool is_string() const { return json_->is_string(); }
  bool is_number() const { return json_->is_number(); }
  bool is_null() const { return json_->is_null(); }

  const std::string& string() const;
  /// Returns a string that is not empty.
  const std::string& name() const;
  bool boolean() const;
  double number() const;
  double number_in(double min, double max) const;
  double positive_number() const;
  double non_negative_number() const;
  std::int64_t integer_in(std::int64_t min, std::int64_t max) const;
  std::uint64_t unsigned_integer() const;
  Index vertex() const;
  Eigen::Vector3d vector3() const;
  /// Returns a vector3 of non-zero length.
  Eigen::Vector3d direction() const;
  Eigen::Matrix3d matrix3() const;
  /// Returns the rows of an affine map; the last one must be 0 0 0 1.
  Eigen::Matrix4d affine_matrix() const;
  /// Returns a list of at least `min_count` points.
  Points points(std::size_t min_count) const;
  std::vector<Index> vertices() const;

  std::size_t size() const;  ///< of a list; fails for anything else
  Value operator[](std::size_t index) const;
  Value member(std::string_view key) const;  ///< of an object that has the key

  /// Returns the value that belongs to a word.
  template <class T>
  T choice(std::initializer_list<std::pair<std::string_view, T>> choices) const {
    const std::string& word = string();
    std::vector<std::string> words;
    for (const auto& [name, value] : choices) {
      if (name == word) return value;
      words.emplace_back(name);
    }
    fail_choice(words);
  }

 private:
  Value(const Json& json, const Value& parent, std::string_view key, std::size_t index)
      : json_(&json), document_(parent.document_), parent_(&parent), key_(key), index_(index) {}
  [[noreturn]] void fail_choice(std::span<const std::string> words) const;

  const Json* json_;
  const std::string* document_;
  const Value* parent_ = nullptr;
  std::string_view key_;  // empty for an element of a list
  std::size_t index_ = 0;
};

/// An object whose fields are all known.
class Object {
 public:
  /// Fails if `value` is not an object or has a field that is not in `known`.
  Object(const Value& value, std::initializer_list<std::string_view> known)
      : Object(value, std::span<const std::string_view>(known.begin(), known.size())) {}
  Object(const Value& value, std::span<const std::string_view> known);

  bool has(std::string_view key) const { return value_->raw().contains(key); }
  Value required(std::string_view key) const;
  /// Calls `read` with the field's value if the field exists.
  template <class F>
  void optional(std::string_view key, F&& read) const {
    if (has(key)) read(value_->member(key));
  }

 private:
  const Value* value_;
};

}  // namespace meshgraft::json
