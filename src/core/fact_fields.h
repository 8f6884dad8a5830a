#pragma once

#include <concepts>
#include <cstdint>
#include <filesystem>
#include <ranges>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <meshgraft/core/error.h>

/// Types of the fields of the records that tools/facts.py makes of the tables. They take what their callers
/// have: any integer, any number, any text or path. None has a default, so that a record without a field does
/// not compile.
namespace meshgraft::facts {

struct Integer {
  template <std::integral T>
  Integer(T integer) : value(static_cast<std::int64_t>(integer)) {}
  std::int64_t value;
};

struct Number {
  template <class T>
    requires std::is_arithmetic_v<T>
  Number(T number) : value(static_cast<double>(number)) {}
  double value;
};

struct Text {
  Text(std::string text) : value(std::move(text)) {}
  Text(std::string_view text) : value(text) {}
  Text(const char* text) : value(text) {}
  Text(const std::filesystem::path& path) : value(path.string()) {}
  std::string value;
};

/// A word of a closed list, which the enumeration E stands for.
template <class E>
struct Word {
  Word(E word) : value(word) {}
  E value;
};

/// A list of integers, numbers or texts.
template <class Element>
struct List {
  template <std::ranges::input_range Range>
  List(Range&& range) {
    for (auto&& element : range) value.push_back(static_cast<Element>(element));
  }
  std::vector<Element> value;
};
using Integers = List<std::int64_t>;
using Numbers = List<double>;
using Texts = List<std::string>;

}  // namespace meshgraft::facts
