#include "wording.h"

#include <algorithm>
#include <iterator>
#include <string_view>

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

}  // namespace meshgraft::cli
