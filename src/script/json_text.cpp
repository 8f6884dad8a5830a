#include "json_text.h"

#include <algorithm>

namespace meshgraft::json {

namespace {

using Document = nlohmann::ordered_json;

constexpr std::size_t line_width = 100;

std::string scalar_text(const Document& value) {
  return value.dump(-1, ' ', false, Document::error_handler_t::replace);
}

// Appends the value in one line. Stops once the text is longer than a line.
bool append_in_line(std::string& text, const Document& value, std::size_t limit) {
  if (!value.is_structured()) {
    text += scalar_text(value);
  } else {
    text += value.is_object() ? '{' : '[';
    bool first = true;
    for (auto item = value.begin(); item != value.end(); ++item) {
      if (!first) text += ", ";
      first = false;
      if (value.is_object()) text += scalar_text(item.key()) + ": ";
      if (!append_in_line(text, *item, limit)) return false;
    }
    text += value.is_object() ? '}' : ']';
  }
  return text.size() <= limit;
}

void append_filled(std::string& text, const Document& list, std::size_t indent) {
  std::string line;
  const auto end_line = [&] {
    text += '\n' + std::string(indent, ' ') + line;
    line.clear();
  };
  for (std::size_t i = 0; i < list.size(); ++i) {
    const std::string item = scalar_text(list[i]) + (i + 1 < list.size() ? "," : "");
    if (!line.empty() && indent + line.size() + 1 + item.size() > line_width) end_line();
    line += (line.empty() ? "" : " ") + item;
  }
  end_line();
}

void append(std::string& text, const Document& value, std::size_t indent) {
  const std::size_t column = text.size() - (text.rfind('\n') == std::string::npos ? 0 : text.rfind('\n') + 1);
  std::string line;
  if (append_in_line(line, value, line_width > column ? line_width - column : 0)) {
    text += line;
    return;
  }
  if (!value.is_structured()) {
    text += scalar_text(value);
    return;
  }
  const std::size_t inner = indent + 2;
  text += value.is_object() ? '{' : '[';
  const bool scalars = value.is_array() && std::none_of(value.begin(), value.end(),
                                                        [](const Document& v) { return v.is_structured(); });
  if (scalars) {
    append_filled(text, value, inner);
  } else {
    bool first = true;
    for (auto item = value.begin(); item != value.end(); ++item) {
      text += (first ? "\n" : ",\n") + std::string(inner, ' ');
      first = false;
      if (value.is_object()) text += scalar_text(item.key()) + ": ";
      append(text, *item, inner);
    }
  }
  text += '\n' + std::string(indent, ' ') + (value.is_object() ? '}' : ']');
}

}  // namespace

std::string to_text(const Document& document) {
  std::string text;
  append(text, document, 0);
  return text + '\n';
}

}  // namespace meshgraft::json
