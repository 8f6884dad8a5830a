#include "fact_json.h"

#include <string>

namespace meshgraft {

namespace {

using Json = nlohmann::ordered_json;

Json fields_json(const Fact& fact) {
  Json fields = Json::object();
  for (std::size_t f = 0; f < fact.values().size(); ++f)
    std::visit([&](const auto& value) { fields[std::string(fact.type().fields[f].name)] = value; },
               fact.values()[f]);
  return fields;
}

}  // namespace

Json to_json(const Fact& fact, const Wording& wording) {
  return {{"id", std::string(fact.id())}, {"fields", fields_json(fact)}, {"text", sentence(fact, wording)}};
}

Json to_json(std::span<const Note> notes, const Wording& wording) {
  Json list = Json::array();
  for (const Note& note : notes) list.push_back(to_json(note, wording));
  return list;
}

Json to_json(const Error& error, const Wording& wording) {
  const FactText text = wording(error.fact());
  return {{"id", std::string(error.id())},
          {"code", std::string(to_string(error.code()))},
          {"location", error.location().text()},
          {"fields", fields_json(error.fact())},
          {"problem", text.statement},
          {"remedy", text.remedy},
          {"notes", to_json(error.notes(), wording)}};
}

}  // namespace meshgraft
