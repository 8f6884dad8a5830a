#include "up_axis_comment.h"

#include <algorithm>

#include "word_cursor.h"

namespace meshgraft::io {

namespace {

char lowered(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

void skip_blanks(std::string_view& text) {
  while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
}

}  // namespace

std::optional<UpAxis> up_axis_in(std::string_view comment) {
  constexpr std::string_view key = "vertical axis:";
  skip_blanks(comment);
  if (!std::ranges::equal(comment.substr(0, key.size()), key, {}, lowered)) return std::nullopt;
  comment.remove_prefix(key.size());
  skip_blanks(comment);
  if (comment.empty() || (comment.size() > 1 && !is_blank(comment[1]))) return std::nullopt;
  switch (lowered(comment.front())) {
    case 'y': return UpAxis::y;
    case 'z': return UpAxis::z;
    default: return std::nullopt;
  }
}

std::optional<UpAxis> up_axis_in_text(std::string_view text, bool only_leading) {
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  while (!text.empty()) {
    const std::size_t end = std::min(text.find_first_of("\n\r"), text.size());
    std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    skip_blanks(line);
    const std::size_t hash = line.find('#');
    if (only_leading && hash != 0 && !line.empty()) break;
    if (hash == std::string_view::npos) continue;
    if (const auto axis = up_axis_in(line.substr(hash + 1))) return axis;
  }
  return std::nullopt;
}

std::string_view up_axis_comment(const Mesh& mesh) {
  return told_up_axis(mesh) == UpAxis::z ? "Vertical axis: z" : "";
}

}  // namespace meshgraft::io
