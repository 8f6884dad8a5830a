#include "wording.h"

#include <algorithm>
#include <iterator>
#include <string_view>
#include <vector>

namespace meshgraft::cli {

namespace {

struct OwnText {
  std::string_view id, text, remedy;
};

constexpr OwnText own_texts[] = {
#include "cli/texts.inc"
};

}  // namespace

FactText text_of(const Fact& fact) {
  const OwnText* own = std::ranges::lower_bound(own_texts, fact.id(), {}, &OwnText::id);
  if (own == std::end(own_texts) || own->id != fact.id()) return {fact.text(), fact.remedy()};
  return {fill_in(own->text, fact), fill_in(own->remedy, fact)};
}

std::string sentence(const Error& error) { return meshgraft::sentence(error, text_of); }

std::string sentence(const Note& note) { return meshgraft::sentence(note, text_of); }

Location at_option(const Location& location, std::size_t outer, const std::string& option) {
  const std::vector<LocationPart>& parts = location.parts();
  std::size_t inner = outer;
  while (inner < parts.size() &&
         (parts[inner].kind == LocationPart::Kind::field || parts[inner].kind == LocationPart::Kind::element))
    ++inner;
  return (option.empty() ? Location() : Location::place(option)) / location.from(inner);
}

}  // namespace meshgraft::cli
