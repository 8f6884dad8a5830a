#include "json_value.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <set>
#include <vector>

#include <fmt/format.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "script/facts.h"

namespace meshgraft::json {

namespace {

std::string line_and_column(std::string_view text, std::size_t byte) {
  const std::string_view before = text.substr(0, std::min(byte > 0 ? byte - 1 : 0, text.size()));
  const auto line = std::count(before.begin(), before.end(), '\n') + 1;
  const std::size_t line_start = before.rfind('\n');
  const std::size_t column = before.size() - (line_start == std::string_view::npos ? 0 : line_start + 1) + 1;
  return fmt::format("line {}, column {}", line, column);
}

// Returns the parser's message without its identifiers, which mean nothing to a user.
std::string reason(std::string_view what) {
  const std::size_t end =
      what.rfind(": ", what.find(" - ") == std::string_view::npos ? what.size() : what.find(" - "));
  return std::string(end == std::string_view::npos ? what : what.substr(end + 2));
}

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t substituted = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({row[j] + 1, row[j + 1] + 1, substituted});
    }
  }
  return row.back();
}

facts::script::Type type_of(const Json& json) {
  using enum facts::script::Type;
  switch (json.type()) {
    case Json::value_t::null: return null;
    case Json::value_t::object: return object;
    case Json::value_t::array: return list;
    case Json::value_t::string: return string;
    case Json::value_t::boolean: return boolean;
    default: return number;
  }
}

}  // namespace

Json parse(std::string_view text, const Location& location, int depth_limit) {
  std::vector<std::set<std::string>> keys;
  const auto watch = [&](int depth, Json::parse_event_t event, Json& parsed) {
    if (depth > depth_limit) throw Error(facts::script::NestedTooDeep{.limit = depth_limit}, location);
    if (event == Json::parse_event_t::object_start) keys.emplace_back();
    if (event == Json::parse_event_t::object_end) keys.pop_back();
    if (event == Json::parse_event_t::key && !keys.back().insert(parsed.get<std::string>()).second)
      throw Error(facts::script::RepeatedField{.field = parsed.get<std::string>()}, location);
    return true;
  };
  try {
    return Json::parse(text.begin(), text.end(), watch);
  } catch (const Json::parse_error& error) {
    throw Error(facts::script::NotJson{.reason = reason(error.what())},
                location / Location::place(line_and_column(text, error.byte)));
  } catch (const Json::exception& error) {
    throw Error(facts::script::NotJson{.reason = reason(error.what())}, location);
  }
}

std::optional<std::string> nearest_name(std::string_view name, std::span<const std::string> candidates) {
  const std::string* best = nullptr;
  std::size_t best_distance = std::max<std::size_t>(1, name.size() / 3) + 1;
  for (const std::string& candidate : candidates) {
    const std::size_t distance = edit_distance(name, candidate);
    if (distance < best_distance) {
      best_distance = distance;
      best = &candidate;
    }
  }
  return best ? std::optional(*best) : std::nullopt;
}

Location Value::location() const {
  std::vector<const Value*> chain;
  for (const Value* value = this; value->parent_; value = value->parent_) chain.push_back(value);
  Location location = Location::file(*document_);
  for (auto value = chain.rbegin(); value != chain.rend(); ++value)
    location = (*value)->key_.empty() ? location[(*value)->index_]
                                      : location / Location::field(std::string((*value)->key_));
  return location;
}

void Value::fail(const Fact& fact) const { throw Error(fact, location()); }

void Value::fail_type(facts::script::Type expected) const {
  fail(facts::script::WrongType{.expected = expected, .found = type_of(*json_)});
}

void Value::fail_choice(std::span<const std::string> words) const {
  if (const auto meant = nearest_name(string(), words))
    fail(facts::script::MisspeltWord{.word = string(), .meant = *meant, .known = words});
  fail(facts::script::UnknownWord{.word = string(), .known = words});
}

const std::string& Value::string() const {
  if (!json_->is_string()) fail_type(facts::script::Type::string);
  return json_->get_ref<const std::string&>();
}

const std::string& Value::name() const {
  if (string().empty()) fail(facts::script::EmptyName{});
  return string();
}

bool Value::boolean() const {
  if (!json_->is_boolean()) fail_type(facts::script::Type::boolean);
  return json_->get<bool>();
}

double Value::number() const {
  if (!json_->is_number()) fail_type(facts::script::Type::number);
  return json_->get<double>();
}

double Value::number_in(double min, double max) const {
  const double value = number();
  if (!(value >= min && value <= max)) fail(facts::core::OutOfRange{.value = value, .low = min, .high = max});
  return value;
}

double Value::positive_number() const {
  const double value = number();
  if (!(value > 0)) fail(facts::core::NotPositive{.value = value});
  return value;
}

double Value::non_negative_number() const {
  const double value = number();
  if (!(value >= 0)) fail(facts::core::Negative{.value = value});
  return value;
}

std::int64_t Value::integer_in(std::int64_t min, std::int64_t max) const {
  if (!json_->is_number_integer()) fail_type(facts::script::Type::integer);
  const bool too_large =
      json_->is_number_unsigned() && json_->get<std::uint64_t>() > static_cast<std::uint64_t>(max);
  if (too_large || json_->get<std::int64_t>() < min || json_->get<std::int64_t>() > max)
    fail(facts::core::OutOfRange{.value = json_->get<double>(), .low = min, .high = max});
  return json_->get<std::int64_t>();
}

std::uint64_t Value::unsigned_integer() const {
  if (!json_->is_number_unsigned()) fail_type(facts::script::Type::index);
  return json_->get<std::uint64_t>();
}

Index Value::vertex() const { return static_cast<Index>(integer_in(0, std::numeric_limits<Index>::max())); }

Eigen::Vector3d Value::vector3() const {
  if (!json_->is_array() || json_->size() != 3) fail(facts::script::NotAVector{.count = 3});
  return {(*this)[0].number(), (*this)[1].number(), (*this)[2].number()};
}

Eigen::Vector3d Value::direction() const {
  const Eigen::Vector3d vector = vector3();
  if (!(vector.norm() > 0)) fail(facts::script::ZeroVector{});
  return vector;
}

Eigen::Matrix3d Value::matrix3() const {
  if (!json_->is_array() || json_->size() != 3) fail(facts::script::NotAMatrix{.size = 3});
  Eigen::Matrix3d matrix;
  for (std::size_t row = 0; row < 3; ++row) matrix.row(static_cast<Eigen::Index>(row)) = (*this)[row].vector3();
  return matrix;
}

Eigen::Matrix4d Value::affine_matrix() const {
  if (!json_->is_array() || json_->size() != 4) fail(facts::script::NotAMatrix{.size = 4});
  Eigen::Matrix4d matrix;
  for (std::size_t r = 0; r < 4; ++r) {
    const Value row = (*this)[r];
    if (!row.is_array() || row.raw().size() != 4) row.fail(facts::script::NotAVector{.count = 4});
    for (std::size_t c = 0; c < 4; ++c)
      matrix(static_cast<Eigen::Index>(r), static_cast<Eigen::Index>(c)) = row[c].number();
  }
  if (matrix.row(3) != Eigen::RowVector4d(0, 0, 0, 1)) (*this)[3].fail(facts::script::NotAffine{});
  return matrix;
}

Points Value::points(std::size_t min_count) const {
  if (size() < min_count)
    fail(facts::script::TooFew{.least = min_count, .what = facts::script::Elements::points});
  Points points(static_cast<Eigen::Index>(size()), 3);
  for (std::size_t i = 0; i < size(); ++i) points.row(static_cast<Eigen::Index>(i)) = (*this)[i].vector3();
  return points;
}

std::vector<Index> Value::vertices() const {
  std::vector<Index> list;
  list.reserve(size());
  for (std::size_t i = 0; i < size(); ++i) list.push_back((*this)[i].vertex());
  return list;
}

std::size_t Value::size() const {
  if (!json_->is_array()) fail_type(facts::script::Type::list);
  return json_->size();
}

Value Value::operator[](std::size_t index) const { return Value((*json_)[index], *this, {}, index); }

Value Value::member(std::string_view key) const {
  const auto found = json_->find(key);
  return Value(*found, *this, found.key(), 0);
}

Object::Object(const Value& value, std::span<const std::string_view> known) : value_(&value) {
  if (!value.is_object()) value.fail_type(facts::script::Type::object);
  for (const auto& [key, member] : value.raw().items()) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    const std::vector<std::string> words(known.begin(), known.end());
    if (const auto meant = nearest_name(key, words))
      value.fail(facts::script::MisspeltField{.field = key, .meant = *meant, .known = words});
    value.fail(facts::script::UnknownField{.field = key, .known = words});
  }
}

Value Object::required(std::string_view key) const {
  if (!has(key)) value_->fail(facts::script::MissingField{.field = key});
  return value_->member(key);
}

}  // namespace meshgraft::json
