#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <string_view>
#include <unordered_set>
#include <utility>

#include <meshgraft/core/error.h>

#include "document.h"
#include "io/charged.h"
#include "io/facts.h"
#include "io/number_text.h"
#include "io/word_cursor.h"
#include "ply.h"

namespace meshgraft::io {

namespace {

struct TypeName {
  std::string_view name;
  ScalarType type;
};

constexpr std::array<TypeName, 16> type_names = {{
    {"char", ScalarType::int8},
    {"int8", ScalarType::int8},
    {"uchar", ScalarType::uint8},
    {"uint8", ScalarType::uint8},
    {"short", ScalarType::int16},
    {"int16", ScalarType::int16},
    {"ushort", ScalarType::uint16},
    {"uint16", ScalarType::uint16},
    {"int", ScalarType::int32},
    {"int32", ScalarType::int32},
    {"uint", ScalarType::uint32},
    {"uint32", ScalarType::uint32},
    {"float", ScalarType::float32},
    {"float32", ScalarType::float32},
    {"double", ScalarType::float64},
    {"float64", ScalarType::float64},
}};

std::vector<std::string_view> split_words(std::string_view line) {
  std::vector<std::string_view> words;
  std::size_t at = 0;
  while ((at = line.find_first_not_of(" \t", at)) != std::string_view::npos) {
    const std::size_t end = std::min(line.find_first_of(" \t", at), line.size());
    words.push_back(line.substr(at, end - at));
    at = end;
  }
  return words;
}

/// Reads the header line by line. Lines end as the line with "ply" does. If that is a lone CR, an LF after
/// end_header is already data.
class HeaderParser {
 public:
  HeaderParser(std::string_view content, const std::string& name, MemoryBudget& budget,
               std::uint64_t file_bytes)
      : content_(content), name_(name), budget_(budget), file_bytes_(file_bytes) {
    if (content.starts_with(byte_order_mark)) offset_ = byte_order_mark.size();
    const std::size_t first_end = content.find_first_of("\r\n", offset_);
    if (first_end == std::string_view::npos) {
      line_begin_ = content.size();
      fail_truncated();
    }
    const bool lone_cr = content[first_end] == '\r' && content.substr(first_end, 2) != "\r\n";
    line_end_ = lone_cr ? '\r' : '\n';
  }

  PlyHeader parse() {
    next_line();  // "ply", which the signature check has found
    parse_format();
    for (;;) {
      const std::string_view line = next_line();
      const std::vector<std::string_view> words = split_words(line);
      if (words.empty() || words[0] == "obj_info") continue;
      if (words[0] == "comment") {
        add_comment(line);
      } else if (words[0] == "element") {
        parse_element(words);
      } else if (words[0] == "property") {
        parse_property(words);
      } else if (words[0] == "end_header") {
        break;
      } else {
        fail_word(words[0], {"format", "comment", "obj_info", "element", "property", "end_header"});
      }
    }
    header_.size = offset_;
    check_counts();
    return std::move(header_);
  }

 private:
  std::string_view next_line() {
    line_begin_ = offset_;
    const std::size_t end = content_.find(line_end_, offset_);
    const bool last = end == std::string_view::npos;
    const std::string_view line = content_.substr(offset_, last ? end : end - offset_);
    // The last line of a file without records may lack its line end.
    if (last && line != "end_header") fail_truncated();
    offset_ = last ? content_.size() : end + 1;
    constexpr std::uint64_t bytes_of_line = 128;  // of the property or the comment that it becomes
    budget_.charge(bytes_of_line + 2 * line.size());
    return line.ends_with('\r') ? line.substr(0, line.size() - 1) : line;
  }

  void add_comment(std::string_view line) {
    constexpr std::string_view keyword = "comment ";
    if (line.starts_with(keyword)) header_.comments.emplace_back(line.substr(keyword.size()));
  }

  void parse_format() {
    std::vector<std::string_view> words;
    std::string_view line;
    do {
      line = next_line();
      words = split_words(line);
      if (!words.empty() && words[0] == "comment") {
        add_comment(line);
      }
    } while (words.empty() || words[0] == "comment" || words[0] == "obj_info");
    if (words[0] != "format") fail_word(words[0], {"format"});
    if (words.size() != 3) fail(facts::io::MalformedLine{.keyword = "format", .form = "format ENCODING 1.0"});
    if (words[1] == "ascii") {
      header_.encoding = PlyEncoding::ascii;
    } else if (words[1] == "binary_little_endian") {
      header_.encoding = PlyEncoding::little_endian;
    } else if (words[1] == "binary_big_endian") {
      header_.encoding = PlyEncoding::big_endian;
    } else {
      fail_word(words[1], {"ascii", "binary_little_endian", "binary_big_endian"});
    }
    if (words[2] != "1.0") fail_word(words[2], {"1.0"});
  }

  void parse_element(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail(facts::io::MalformedLine{.keyword = "element", .form = "element NAME COUNT"});
    if (!names_.emplace(words[1]).second) fail(facts::io::DuplicateElement{.element = std::string(words[1])});
    // Counts beyond 2^31 fit neither meshgraft's indices nor any memory.
    const ParsedNumber count = parse_number(words[2], ScalarType::int32);
    if (count.fault != NumberFault::none || count.value < 0)
      fail(facts::io::BadCount{.element = shown(words[1]), .word = shown(words[2])});
    header_.elements.push_back({std::string(words[1]), static_cast<std::uint64_t>(count.value), {}});
  }

  void parse_property(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail_word(words[0], {"element"});
    const bool is_list = words.size() == 5 && words[1] == "list";
    if (!is_list && words.size() != 3)
      fail(facts::io::MalformedLine{.keyword = "property", .form = "property [list LENGTH_TYPE] TYPE NAME"});
    PlyProperty property;
    property.name = std::string(words.back());
    property.is_list = is_list;
    property.type = parse_type(words[words.size() - 2]);
    if (is_list) {
      property.count_type = parse_type(words[2]);
      if (!is_integer(property.count_type))
        fail(facts::io::NonIntegerType{.element = header_.elements.back().name,
                                       .list = property.name,
                                       .part = facts::io::ListPart::length});
    }
    header_.elements.back().properties.push_back(std::move(property));
  }

  ScalarType parse_type(std::string_view word) const {
    for (const TypeName& entry : type_names) {
      if (entry.name == word) return entry.type;
    }
    fail_word(word, {"char", "uchar", "short", "ushort", "int", "uint", "float", "double"});
  }

  /// Checks that the smallest possible size of all records fits into the file.
  void check_counts() const {
    const std::size_t body = file_bytes_ - header_.size;
    std::size_t left = body;
    for (const PlyElement& element : header_.elements) {
      std::size_t record = element.smallest_binary_size();
      // A value in ascii takes a character and a separator; the very last separator may be missing.
      if (header_.encoding == PlyEncoding::ascii) record = 2 * element.properties.size();
      if (record == 0) continue;
      const std::size_t available = header_.encoding == PlyEncoding::ascii ? left + 1 : left;
      if (element.count > available / record)
        throw Error(facts::io::TooShort{.element = element.name, .count = element.count},
                    Location::file(name_));
      left -= std::min<std::size_t>(left, element.count * record);
    }
  }

  [[noreturn]] void fail(Fact fact) const {
    throw Error(std::move(fact), Location::file(name_) / Location::place(line_name(content_, line_begin_)));
  }
  [[noreturn]] void fail_word(std::string_view word, std::initializer_list<std::string_view> expected) const {
    fail(facts::io::UnexpectedWord{.word = shown(word), .expected = expected});
  }
  [[noreturn]] void fail_truncated() const { fail(facts::io::Truncated{.missing = "end_header"}); }

  std::string_view content_;
  const std::string& name_;
  MemoryBudget& budget_;
  std::uint64_t file_bytes_;
  char line_end_ = '\n';
  std::size_t offset_ = 0;
  std::size_t line_begin_ = 0;
  PlyHeader header_;
  std::unordered_set<std::string_view> names_;  // of the elements
};

}  // namespace

bool has_ply_signature(std::string_view content) {
  if (content.starts_with(byte_order_mark)) content.remove_prefix(byte_order_mark.size());
  return content.starts_with("ply\n") || content.starts_with("ply\r") || content == "ply";
}

Format ply_format() {
  static constexpr std::array<std::string_view, 1> extensions = {".ply"};
  return {"PLY", extensions, has_ply_signature, read_ply, write_ply};
}

bool PlyElement::has_lists() const {
  return std::ranges::any_of(properties, [](const PlyProperty& property) { return property.is_list; });
}

std::size_t PlyElement::smallest_binary_size() const {
  std::size_t size = 0;
  for (const PlyProperty& property : properties)
    size += size_of(property.is_list ? property.count_type : property.type);
  return size;
}

PlyHeader parse_ply_header(std::string_view content, const std::string& name, MemoryBudget& budget,
                           std::optional<std::uint64_t> file_bytes) {
  if (!has_ply_signature(content))
    throw Error(facts::io::NotThisFormat{.format = "PLY", .beginning = "ply"},
                Location::file(name) / Location::place("line 1"));
  return HeaderParser(content, name, budget, file_bytes.value_or(content.size())).parse();
}

bool PlyTextCursor::at_end() {
  while (offset_ < content_.size() && (is_blank(content_[offset_]) || is_line_end(content_[offset_])))
    ++offset_;
  return offset_ == content_.size();
}

void PlyTextCursor::begin_record(const PlyElement& element, std::uint64_t row) {
  element_ = &element;
  row_ = row;
  // An element without properties has no values on a line.
  if (!element.properties.empty() && at_end())
    throw Error(facts::io::TruncatedRecords{.element = element.name, .read = row, .count = element.count},
                Location::file(name_) / Location::place(line_name(content_, content_.size())));
}

double PlyTextCursor::scalar(const PlyProperty& property, ScalarType type) {
  while (offset_ < content_.size() && is_blank(content_[offset_])) ++offset_;
  value_begin_ = offset_;
  while (offset_ < content_.size() && !is_blank(content_[offset_]) && !is_line_end(content_[offset_]))
    ++offset_;
  const std::string_view text = content_.substr(value_begin_, offset_ - value_begin_);
  if (text.empty()) fail(facts::io::MissingValue{.element = element_->name, .value = property.name});
  const ParsedNumber number = parse_number(text, type);
  if (number.fault != NumberFault::none)
    fail(bad_number(element_->name, property.name, text, type, number.fault));
  return number.value;
}

void PlyTextCursor::end_record() {
  while (offset_ < content_.size() && is_blank(content_[offset_])) ++offset_;
  if (offset_ < content_.size() && !is_line_end(content_[offset_]) && !element_->properties.empty()) {
    fail(facts::io::ExtraValues{.element = element_->name});
  }
}

void PlyTextCursor::fail(Fact fact) const {
  throw Error(std::move(fact), Location::file(name_) / Location::place(line_name(content_, offset_)));
}

}  // namespace meshgraft::io
