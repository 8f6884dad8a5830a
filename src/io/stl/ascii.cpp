#include <algorithm>

#include "document.h"
#include "io/facts.h"
#include "io/number_text.h"

namespace meshgraft::io {

bool is_stl_keyword(std::string_view word, std::string_view keyword) {
  const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; };
  return std::ranges::equal(word, keyword, {}, lower);
}

bool StlTextCursor::next_facet(StlFacetText& facet) {
  for (;;) {
    if (!in_solid_ && !next_solid()) return false;
    const std::string_view word = words_.next();
    if (is_stl_keyword(word, "facet")) break;
    if (!is_stl_keyword(word, "endsolid")) fail_keyword(word, {"endsolid", "facet"});
    words_.rest_of_line();  // the name after 'endsolid'
    in_solid_ = false;
  }
  std::size_t value = 0;
  const auto read_vector = [&](const char* name) {
    for (int axis = 0; axis < 3; ++axis, ++value) {
      facet.words[value] = words_.next();
      if (!WordCursor::to_number(facet.words[value], ScalarType::float64, facet.values[value]))
        words_.fail_number(facet.words[value], ScalarType::float64, {"facet", name});
    }
  };
  expect("normal");
  read_vector("normal");
  expect("outer");
  expect("loop");
  for (int corner = 0; corner < 3; ++corner) {
    expect("vertex");
    read_vector("vertex");
  }
  expect("endloop");
  expect("endfacet");
  return true;
}

bool StlTextCursor::next_solid() {
  const std::string_view word = words_.next();
  if (word.empty() && solid_count_ > 0) return false;
  if (!is_stl_keyword(word, "solid")) fail_keyword(word, {"solid"});
  ++solid_count_;
  solid_name_ = words_.rest_of_line();
  in_solid_ = true;
  return true;
}

void StlTextCursor::expect(std::string_view keyword) {
  const std::string_view word = words_.next();
  if (!is_stl_keyword(word, keyword)) fail_keyword(word, {keyword});
}

void StlTextCursor::fail_keyword(std::string_view word,
                                 std::initializer_list<std::string_view> expected) const {
  if (word.empty()) words_.fail(facts::io::Truncated{.missing = *expected.begin()});
  words_.fail(facts::io::UnexpectedWord{.word = shown(word), .expected = expected});
}

}  // namespace meshgraft::io
