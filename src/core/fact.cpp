#include <meshgraft/core/error.h>

#include <algorithm>
#include <stdexcept>
#include <string>
#include <type_traits>

#include <fmt/args.h>
#include <fmt/ranges.h>

namespace meshgraft {

namespace {

template <class T>
constexpr bool is_list = false;
template <class T>
constexpr bool is_list<std::vector<T>> = true;

/// An integer. "{n:face|faces}" writes "1 face", "3 faces"; all other formats are those of integers.
struct Count {
  std::int64_t value;
};

/// Returns the text of a word in the library's sentences.
std::string_view text_of_word(const FieldType& field, std::string_view word) {
  const auto found = std::ranges::find(field.words, word, &FieldWord::name);
  return found == field.words.end() ? word : found->text;
}

}  // namespace

}  // namespace meshgraft

template <>
struct fmt::formatter<meshgraft::Count> : fmt::formatter<std::int64_t> {
  constexpr auto parse(format_parse_context& context) {
    const std::string_view all(context.begin(), static_cast<std::size_t>(context.end() - context.begin()));
    const std::string_view spec = all.substr(0, all.find('}'));
    const std::size_t bar = spec.find('|');
    if (bar == std::string_view::npos) return fmt::formatter<std::int64_t>::parse(context);
    one = spec.substr(0, bar);
    many = spec.substr(bar + 1);
    return context.begin() + spec.size();
  }
  auto format(meshgraft::Count count, format_context& context) const {
    if (many.empty()) return fmt::formatter<std::int64_t>::format(count.value, context);
    return fmt::format_to(context.out(), "{} {}", count.value, count.value == 1 ? one : many);
  }
  std::string_view one, many;
};

namespace meshgraft {

const FieldValue& Fact::value(std::string_view field) const {
  for (std::size_t f = 0; f < type_->fields.size(); ++f)
    if (type_->fields[f].name == field) return values_.at(f);
  throw std::out_of_range(fmt::format("the fact {} has no field {}", id(), field));
}

std::string Fact::text() const { return fill_in(type_->text, *this); }

std::string Fact::remedy() const { return fill_in(type_->remedy, *this); }

FactText library_text(const Fact& fact) { return {fact.text(), fact.remedy()}; }

std::string fill_in(std::string_view text, const Fact& fact) {
  fmt::dynamic_format_arg_store<fmt::format_context> values;
  for (std::size_t f = 0; f < fact.values().size(); ++f) {
    const FieldType& field = fact.type().fields[f];
    const std::string name(field.name);
    std::visit(
        [&]<class T>(const T& value) {
          if constexpr (is_list<T>)
            values.push_back(fmt::arg(name.c_str(), fmt::format("{}", fmt::join(value, ", "))));
          else if constexpr (std::is_same_v<T, std::int64_t>)
            values.push_back(fmt::arg(name.c_str(), Count{value}));
          else if constexpr (std::is_same_v<T, std::string>)
            values.push_back(fmt::arg(name.c_str(), std::string(text_of_word(field, value))));
          else
            values.push_back(fmt::arg(name.c_str(), value));
        },
        fact.values()[f]);
  }
  return fmt::vformat(text, values);
}

}  // namespace meshgraft
