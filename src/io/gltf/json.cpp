#include "json.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "gltf/facts.h"
#include "io/number_text.h"

namespace meshgraft::io {

namespace {

constexpr std::size_t deepest_nesting = 200;

bool is_json_blank(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// Refuses deep nesting. Comparing and patching values recurse, so a hostile file could exhaust the stack.
/// Returns the number of brackets that open, commas and colons: at least that of the values.
std::size_t require_shallow(std::string_view text, const std::string& file) {
  std::size_t depth = 0;
  std::size_t values = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == ',' || c == ':') {
      ++values;
    } else if (c == '{' || c == '[') {
      ++values;
      if (++depth > deepest_nesting)
        throw Error(facts::gltf::JsonTooDeep{.deepest = deepest_nesting},
                    Location::file(file) / Location::place(line_name(text, i)));
    } else if ((c == '}' || c == ']') && depth > 0) {
      --depth;
    }
  }
  return values;
}

/// Copies a JSON text value by value and replaces the values that differ. The text must be well formed and
/// read as `before`.
class JsonPatcher {
 public:
  explicit JsonPatcher(std::string_view text) : text_(text) {}

  std::string patch(const Json& before, const Json& after) {
    if (text_.starts_with("\xEF\xBB\xBF")) at_ = 3;  // byte order mark
    patch_value(before, after);
    copy_until(text_.size());
    return std::move(out_);
  }

 private:
  /// Patches one value. Starts at the value or at blanks before it, and ends behind it.
  void patch_value(const Json& before, const Json& after) {
    skip_blanks();
    const std::size_t begin = at_;
    if (before == after) return skip_value();
    const bool objects = before.is_object() && after.is_object();
    const bool arrays = before.is_array() && after.is_array() && before.size() <= after.size();
    if ((objects && can_patch_members(before, after)) || (arrays && !before.empty())) {
      at_ = begin;
      return objects ? patch_members(before, after) : patch_elements(before, after);
    }
    at_ = begin;
    skip_value();
    replace(begin, after.dump());
  }

  /// Returns whether the members can be patched one by one. They cannot if one was removed or is written twice,
  /// because readers differ in which of the two counts.
  bool can_patch_members(const Json& before, const Json& after) {
    if (before.empty()) return false;
    for (const auto& member : before.items())
      if (!after.contains(member.key())) return false;
    std::size_t members = 0;
    for (enter(); !leave(); ++members) read_key();
    return members == before.size();
  }

  void patch_members(const Json& before, const Json& after) {
    std::size_t value_end = at_;
    std::string separator;
    for (enter(); !leave(&separator);) {
      const std::string key = read_key(false);
      patch_value(before.at(key), after.at(key));
      value_end = at_;
    }
    std::string added;
    for (const auto& member : after.items())
      if (!before.contains(member.key()))
        added += "," + separator + Json(member.key()).dump() + ":" + member.value().dump();
    insert(value_end, added);
  }

  void patch_elements(const Json& before, const Json& after) {
    std::size_t value_end = at_;
    std::string separator;
    std::size_t element = 0;
    for (enter(); !leave(&separator); ++element) {
      patch_value(before[element], after[element]);
      value_end = at_;
    }
    std::string added;
    for (; element < after.size(); ++element) added += "," + separator + after[element].dump();
    insert(value_end, added);
  }

  /// Moves behind the bracket that opens an object or an array.
  void enter() {
    skip_blanks();
    ++at_;
  }

  /// Returns true and moves behind the closing bracket if no further member or element follows. Otherwise
  /// `separator` gets the blanks before the next one.
  bool leave(std::string* separator = nullptr) {
    std::size_t begin = at_;
    skip_blanks();
    if (text_[at_] == ',') {
      begin = ++at_;
      skip_blanks();
    }
    const bool done = text_[at_] == '}' || text_[at_] == ']';
    if (!done && separator != nullptr) *separator = text_.substr(begin, at_ - begin);
    if (done) ++at_;
    return done;
  }

  /// Reads the member's key at the current position. Moves behind the member's value, or to the value if
  /// `skip` is false.
  std::string read_key(bool skip = true) {
    const std::size_t begin = at_;
    skip_string();
    std::string key = Json::parse(text_.substr(begin, at_ - begin)).get<std::string>();
    skip_blanks();
    ++at_;  // the colon
    if (skip) {
      skip_blanks();
      skip_value();
    }
    return key;
  }

  void skip_blanks() {
    while (at_ < text_.size() && is_json_blank(text_[at_])) ++at_;
  }

  void skip_string() {
    for (++at_; text_[at_] != '"'; ++at_)
      if (text_[at_] == '\\') ++at_;
    ++at_;
  }

  void skip_value() {
    std::size_t depth = 0;
    do {
      const char c = text_[at_];
      if (c == '"') {
        skip_string();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if (c == '}' || c == ']') --depth;
      ++at_;
      if (depth == 0 && (c == '}' || c == ']')) return;
    } while (at_ < text_.size() && (depth > 0 || !ends_scalar(text_[at_])));
  }

  static bool ends_scalar(char c) { return is_json_blank(c) || c == ',' || c == '}' || c == ']'; }

  void replace(std::size_t begin, const std::string& value) {
    copy_until(begin);
    out_ += value;
    copied_ = at_;
  }

  void insert(std::size_t where, const std::string& added) {
    if (added.empty()) return;
    copy_until(where);
    out_ += added;
  }

  void copy_until(std::size_t end) {
    out_.append(text_, copied_, end - copied_);
    copied_ = end;
  }

  std::string_view text_;
  std::string out_;
  std::size_t at_ = 0;
  std::size_t copied_ = 0;
};

}  // namespace

Json parse_gltf_json(std::string_view text, const std::string& file, MemoryBudget* budget) {
  // A value takes 16 bytes, a member of an object 48, and as much again while a list grows.
  constexpr std::uint64_t bytes_of_value = 64;
  const std::size_t values = require_shallow(text, file);
  if (budget != nullptr) budget->charge(text.size() + values * bytes_of_value);
  Json json;
  try {
    json = Json::parse(text);
  } catch (const Json::parse_error& error) {
    const std::size_t byte = std::min(text.size(), error.byte > 0 ? error.byte - 1 : 0);
    throw Error(facts::gltf::JsonMalformed{}, Location::file(file) / Location::place(line_name(text, byte)));
  } catch (const Json::exception&) {
    throw Error(facts::gltf::JsonNumberTooLarge{}, Location::file(file));
  }
  if (!json.is_object()) throw Error(facts::gltf::JsonNotAnObject{}, Location::file(file));
  return json;
}

std::string patch_json_text(std::string_view text, const Json& before, const Json& after) {
  return before == after ? std::string(text) : JsonPatcher(text).patch(before, after);
}

std::optional<JsonView> JsonView::find(const std::string& key) const {
  if (!json_->is_object()) fail(facts::gltf::WrongType{.needed = facts::gltf::Type::object});
  const auto member = json_->find(key);
  if (member == json_->end()) return std::nullopt;
  return JsonView(*member, path_.empty() ? key : path_ + "." + key, *file_);
}

JsonView JsonView::at(const std::string& key) const {
  auto member = find(key);
  if (!member) fail(facts::gltf::MemberMissing{.member = key});
  return *member;
}

JsonView JsonView::at(std::size_t element) const {
  if (element >= size())
    fail(facts::gltf::IndexOutOfRange{.index = element, .count = size(), .array = "elements"});
  return JsonView((*json_)[element], fmt::format("{}[{}]", path_, element), *file_);
}

std::size_t JsonView::count(const std::string& key) const {
  const auto member = find(key);
  return member ? member->size() : 0;
}

std::size_t JsonView::size() const {
  if (!json_->is_array()) fail(facts::gltf::WrongType{.needed = facts::gltf::Type::array});
  return json_->size();
}

std::string JsonView::text() const {
  if (!json_->is_string()) fail(facts::gltf::WrongType{.needed = facts::gltf::Type::text});
  return json_->get<std::string>();
}

double JsonView::number() const {
  if (!json_->is_number()) fail(facts::gltf::WrongType{.needed = facts::gltf::Type::number});
  return json_->get<double>();
}

std::uint64_t JsonView::whole() const {
  const double value = number();
  if (!(value >= 0 && value <= 9007199254740992.0 && std::floor(value) == value))
    fail(facts::gltf::WrongType{.needed = facts::gltf::Type::index});
  return static_cast<std::uint64_t>(value);
}

std::uint64_t JsonView::whole(const std::string& key, std::uint64_t otherwise) const {
  const auto member = find(key);
  return member ? member->whole() : otherwise;
}

bool JsonView::flag(const std::string& key) const {
  const auto member = find(key);
  if (!member) return false;
  if (!member->json_->is_boolean()) member->fail(facts::gltf::WrongType{.needed = facts::gltf::Type::boolean});
  return member->json_->get<bool>();
}

std::size_t JsonView::index(std::size_t count, std::string_view what) const {
  const std::uint64_t value = whole();
  if (value >= count) fail(facts::gltf::IndexOutOfRange{.index = value, .count = count, .array = what});
  return static_cast<std::size_t>(value);
}

void JsonView::fail(const Fact& fact) const {
  const Location file = Location::file(*file_);
  throw Error(fact, path_.empty() ? file : file / Location::field(path_));
}

}  // namespace meshgraft::io
