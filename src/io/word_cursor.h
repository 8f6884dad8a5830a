#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <utility>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft::io {

inline constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";  // of UTF-8

/// Returns whether a character separates words within a line.
inline bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }
inline bool is_line_end(char c) { return c == '\n' || c == '\r'; }

/// Throws Error(input) with the id io.not_text at the first zero byte, which no text has. `format` is the
/// common name of the format.
void require_text(std::string_view content, const std::string& name, std::string_view format);

/// The name of a value in the terms of a format, for messages: the position of vertex 3.
struct ValueName {
  std::string_view element, value;
  Index number = -1;  ///< of the element; -1: unknown
};

/// Walks over the words of a text. Lines end in LF, CRLF or CR. A byte order mark is skipped.
class WordCursor {
 public:
  enum class Comments { none, hash };  ///< hash: '#' makes the rest of a line a comment

  /// `name` is the file's, for messages.
  WordCursor(std::string_view content, const std::string& name, Comments comments, std::size_t offset = 0);

  /// Returns the next word on any line, or an empty one at the end of the file.
  std::string_view next();

  /// Returns the next word of this line, or an empty one if there is none.
  std::string_view next_on_line();

  /// Returns the rest of this line without surrounding blanks. Comments are not recognised.
  std::string_view rest_of_line();

  /// Returns the next word as a number: this value of this element in the format's terms.
  double number(ScalarType type, const ValueName& name) {
    const std::string_view word = next();
    double value = 0;
    if (!to_number(word, type, value)) fail_number(word, type, name);
    return value;
  }

  std::size_t offset() const { return offset_; }
  std::size_t word_begin() const { return word_begin_; }
  std::size_t remaining() const { return content_.size() - offset_; }

  /// Throws Error(input) at the line of the last word.
  [[noreturn]] void fail(Fact fact) const;
  /// Throws Error(input) at the line of the last word and at this element.
  [[noreturn]] void fail(Fact fact, std::string_view element, Index number) const;
  /// The same for a word that is no number, or missing.
  [[noreturn]] void fail_number(std::string_view word, ScalarType type, const ValueName& name) const;

  static bool to_number(std::string_view word, ScalarType type, double& value);

 private:
  std::string_view take_word();

  std::string_view content_;
  const std::string* name_;
  Comments comments_;
  std::size_t offset_;
  std::size_t word_begin_;
};

/// Copies a text and replaces some of its words.
class WordReplacer {
 public:
  explicit WordReplacer(std::string_view content) : content_(content) { out_.reserve(content.size()); }

  /// Replaces `word`, a part of the content, by `text`. Words must be replaced in order.
  void replace(std::string_view word, std::string_view text) {
    const auto begin = static_cast<std::size_t>(word.data() - content_.data());
    out_.append(content_, copied_, begin - copied_);
    out_ += text;
    copied_ = begin + word.size();
  }
  std::string finish() {
    out_.append(content_, copied_);
    return std::move(out_);
  }

 private:
  std::string_view content_;
  std::string out_;
  std::size_t copied_ = 0;
};

}  // namespace meshgraft::io
