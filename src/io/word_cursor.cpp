#include "word_cursor.h"

#include <meshgraft/core/error.h>

#include "io/facts.h"
#include "number_text.h"

namespace meshgraft::io {

void require_text(std::string_view content, const std::string& name, std::string_view format) {
  const std::size_t zero = content.find('\0');
  if (zero == std::string_view::npos) return;
  throw Error(facts::io::NotText{.format = format},
              Location::file(name) / Location::place("byte " + std::to_string(zero)));
}

WordCursor::WordCursor(std::string_view content, const std::string& name, Comments comments, std::size_t offset)
    : content_(content), name_(&name), comments_(comments), offset_(offset), word_begin_(offset) {
  if (offset_ == 0 && content_.starts_with("\xEF\xBB\xBF")) offset_ = 3;
}

std::string_view WordCursor::next() {
  for (;;) {
    const std::string_view word = next_on_line();
    if (!word.empty()) return word;
    while (offset_ < content_.size() && !is_line_end(content_[offset_])) ++offset_;  // a comment
    while (offset_ < content_.size() && is_line_end(content_[offset_])) ++offset_;
    word_begin_ = offset_;
    if (offset_ == content_.size()) return {};
  }
}

std::string_view WordCursor::next_on_line() {
  while (offset_ < content_.size() && is_blank(content_[offset_])) ++offset_;
  word_begin_ = offset_;
  return take_word();
}

std::string_view WordCursor::take_word() {
  while (offset_ < content_.size()) {
    const char c = content_[offset_];
    if (is_blank(c) || is_line_end(c) || (c == '#' && comments_ == Comments::hash)) break;
    ++offset_;
  }
  return content_.substr(word_begin_, offset_ - word_begin_);
}

std::string_view WordCursor::rest_of_line() {
  while (offset_ < content_.size() && is_blank(content_[offset_])) ++offset_;
  word_begin_ = offset_;
  while (offset_ < content_.size() && !is_line_end(content_[offset_])) ++offset_;
  std::size_t end = offset_;
  while (end > word_begin_ && is_blank(content_[end - 1])) --end;
  return content_.substr(word_begin_, end - word_begin_);
}

bool WordCursor::to_number(std::string_view word, ScalarType type, double& value) {
  const ParsedNumber parsed = parse_number(word, type);
  value = parsed.value;
  return parsed.fault == NumberFault::none;
}

void WordCursor::fail_number(std::string_view word, ScalarType type, const ValueName& name) const {
  if (word.empty()) fail(facts::io::Truncated{.missing = name.value}, name.element, name.number);
  fail(bad_number(name.element, name.value, word, type, parse_number(word, type).fault), name.element,
       name.number);
}

void WordCursor::fail(Fact fact) const { fail(std::move(fact), {}, -1); }

void WordCursor::fail(Fact fact, std::string_view element, Index number) const {
  Location location = Location::file(*name_) / Location::place(line_name(content_, word_begin_));
  if (number >= 0) location = location / Location::place(std::string(element) + " " + std::to_string(number));
  throw Error(std::move(fact), std::move(location));
}

}  // namespace meshgraft::io
