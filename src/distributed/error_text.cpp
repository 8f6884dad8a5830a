#include "error_text.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <utility>
#include <variant>
#include <vector>

#include <nlohmann/json.hpp>

namespace meshgraft::distributed {

namespace {

using Json = nlohmann::json;

Json json_of_fact(const Fact& fact) {
  Json values = Json::array();
  for (const FieldValue& value : fact.values())
    std::visit([&](const auto& held) { values.push_back(held); }, value);
  return {{"id", fact.id()}, {"values", values}};
}

double number_of(const Json& json) {
  return json.is_null() ? std::numeric_limits<double>::quiet_NaN() : json.get<double>();
}

FieldValue value_of(const Json& json, FieldKind kind) {
  switch (kind) {
    case FieldKind::integer: return json.get<std::int64_t>();
    case FieldKind::number: return number_of(json);
    case FieldKind::integers: return json.get<std::vector<std::int64_t>>();
    case FieldKind::numbers: {
      std::vector<double> numbers;
      for (const Json& entry : json) numbers.push_back(number_of(entry));
      return numbers;
    }
    case FieldKind::texts: return json.get<std::vector<std::string>>();
    case FieldKind::text:
    case FieldKind::word: break;
  }
  return json.get<std::string>();
}

Fact fact_of_json(const Json& json) {
  const auto id = json.at("id").get<std::string>();
  const auto types = fact_types();
  const auto type =
      std::find_if(types.begin(), types.end(), [&](const FactType* one) { return one->id == id; });
  if (type == types.end()) throw std::runtime_error("another rank sent an unknown error: " + id);
  std::vector<FieldValue> values;
  for (std::size_t k = 0; k < (*type)->fields.size(); ++k)
    values.push_back(value_of(json.at("values").at(k), (*type)->fields[k].kind));
  return Fact(**type, std::move(values));
}

Location location_of(const Json& json) {
  Location location;
  for (const Json& part : json) {
    const auto name = part.at("name").get<std::string>();
    switch (static_cast<LocationPart::Kind>(part.at("kind").get<int>())) {
      case LocationPart::Kind::file: location = location / Location::file(name); break;
      case LocationPart::Kind::field: location = location / Location::field(name); break;
      case LocationPart::Kind::element: location = location[part.at("index").get<std::size_t>()]; break;
      case LocationPart::Kind::handle: location = location / Location::handle(name); break;
      case LocationPart::Kind::pair:
        location = location / Location::pair(part.at("index").get<std::size_t>());
        break;
      case LocationPart::Kind::place: location = location / Location::place(name); break;
    }
  }
  return location;
}

}  // namespace

std::string text_of_error(const Error& error) {
  Json json = json_of_fact(error.fact());
  json["location"] = Json::array();
  for (const LocationPart& part : error.location().parts())
    json["location"].push_back(
        {{"kind", static_cast<int>(part.kind)}, {"name", part.name}, {"index", part.index}});
  json["notes"] = Json::array();
  for (const Note& note : error.notes()) json["notes"].push_back(json_of_fact(note));
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Error error_of_text(std::string_view text) {
  const Json json = Json::parse(text);
  Error error(fact_of_json(json), location_of(json.at("location")));
  for (const Json& note : json.at("notes")) error = error.with(fact_of_json(note));
  return error;
}

}  // namespace meshgraft::distributed
