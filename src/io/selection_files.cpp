#include "selection_files.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <optional>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "io/facts.h"

namespace meshgraft {

namespace {

// A word of a text with its line; `#` starts a comment.
struct Word {
  std::string_view text;
  int line = 0;
};

std::vector<Word> words_of(std::string_view text) {
  constexpr std::string_view blank = " \t\r\f\v";
  std::vector<Word> words;
  int line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, std::min(text.find('#'), end));
    text.remove_prefix(std::min(end + 1, text.size()));
    for (;;) {
      const std::size_t first = rest.find_first_not_of(blank);
      if (first == std::string_view::npos) break;
      rest.remove_prefix(first);
      const std::size_t length = std::min(rest.find_first_of(blank), rest.size());
      words.push_back({rest.substr(0, length), line});
      rest.remove_prefix(length);
    }
  }
  return words;
}

Location line_of(const Location& location, const Word& word) {
  return location / Location::place("line " + std::to_string(word.line));
}

std::string shortened(std::string_view text) {
  constexpr std::size_t longest = 40;
  return std::string(text.substr(0, longest)) + (text.size() > longest ? "…" : "");
}

template <typename Number>
std::optional<Number> parse_number(std::string_view text) {
  if (text.size() > 1 && text[0] == '+' && text[1] != '-') text.remove_prefix(1);
  Number number{};
  const auto [end, status] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (status != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

SelRoles parse_sel(std::string_view text, Index vertex_count, const Location& location) {
  SelRoles sel;
  Index vertex = 0;
  for (const Word& word : words_of(text)) {
    if (vertex == vertex_count)
      throw Error(facts::io::MoreStatesThanVertices{.count = vertex_count}, line_of(location, word));
    const auto status = parse_number<int>(word.text);
    if (status == 0) {
      sel.fixed.push_back(vertex);
    } else if (status == 1) {
      sel.free.push_back(vertex);
    } else if (status == 2) {
      sel.handle.push_back(vertex);
    } else {
      throw Error(facts::io::NotAState{.word = shortened(word.text)}, line_of(location, word));
    }
    ++vertex;
  }
  if (vertex < vertex_count)
    throw Error(facts::io::FewerStatesThanVertices{.given = vertex, .count = vertex_count}, location);
  return sel;
}

std::vector<Index> parse_indices(std::string_view text, Index vertex_count, const Location& location) {
  Flags seen(vertex_count, false);
  std::vector<Index> indices;
  for (const Word& word : words_of(text)) {
    const auto number = parse_number<std::int64_t>(word.text);
    if (!number) throw Error(facts::io::NotAnIndex{.word = shortened(word.text)}, line_of(location, word));
    if (*number < 0 || *number >= vertex_count)
      throw Error(facts::core::NoSuchVertex{.vertex = *number, .count = vertex_count}, line_of(location, word));
    const auto v = static_cast<Index>(*number);
    if (!seen[v]) indices.push_back(v);
    seen[v] = true;
  }
  return indices;
}

Eigen::Matrix4d parse_def(std::string_view text, const Location& location) {
  Eigen::Matrix4d matrix;
  int entry = 0;
  for (const Word& word : words_of(text)) {
    if (entry == 16) throw Error(facts::io::MatrixTooLong{}, line_of(location, word));
    const auto number = parse_number<double>(word.text);
    if (!number || !std::isfinite(*number))
      throw Error(facts::io::NotAFiniteNumber{.word = shortened(word.text)}, line_of(location, word));
    const int row = entry / 4;
    const int column = entry % 4;
    if (row == 3 && *number != (column == 3 ? 1 : 0))
      throw Error(facts::io::MatrixNotAffine{}, line_of(location, word));
    matrix(row, column) = *number;
    ++entry;
  }
  if (entry < 16) throw Error(facts::io::MatrixTooShort{.count = entry}, location);
  return matrix;
}

}  // namespace meshgraft
