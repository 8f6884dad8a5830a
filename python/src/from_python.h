#pragma once

#include <optional>
#include <string>
#include <type_traits>

#include <nanobind/nanobind.h>

#include <meshgraft/script/report.h>

#include "record_tables.h"
#include "to_python.h"

namespace meshgraft::python {

/// Throws TypeError "NAME: expected WHAT".
[[noreturn]] inline void fail_type(const char* name, const std::string& what) {
  throw nb::type_error((std::string(name) + ": expected " + what).c_str());
}

/// Reads one keyword into a field of options. Throws TypeError for a value of another type, ValueError for a
/// word that is none of the list.
template <class T>
void read_keyword(const char* name, nb::handle value, T& field) {
  if constexpr (std::is_same_v<T, bool>) {
    if (!nb::isinstance<nb::bool_>(value)) fail_type(name, "True or False");
    field = nb::cast<bool>(value);
  } else if constexpr (Worded<T>) {
    std::string words;
    std::string given;
    if (!nb::try_cast(value, given)) fail_type(name, "a string");
    for (const auto& word : Words<T>::list) {
      if (given == word.name) {
        field = word.value;
        return;
      }
      words += std::string(words.empty() ? "" : ", ") + "'" + word.name + "'";
    }
    throw nb::value_error((std::string(name) + ": '" + given + "' is none of " + words).c_str());
  } else if constexpr (std::is_integral_v<T>) {
    if (nb::isinstance<nb::bool_>(value) || !nb::try_cast(value, field)) fail_type(name, "an integer");
  } else if constexpr (std::is_floating_point_v<T>) {
    if (nb::isinstance<nb::bool_>(value) || !nb::try_cast(value, field)) fail_type(name, "a number");
  } else if constexpr (std::is_same_v<T, std::string>) {
    if (!nb::isinstance<nb::str>(value)) fail_type(name, "a string");
    field = nb::cast<std::string>(value);
  } else if constexpr (std::is_same_v<T, Method>) {
    if (!nb::isinstance<nb::str>(value)) fail_type(name, "a string");
    field = method_named(nb::cast<std::string>(value));
  } else if constexpr (detail::IsOptional<T>::value) {
    if (value.is_none())
      field.reset();
    else
      read_keyword(name, value, field.emplace());
  } else {
    fail_type(name, "nothing: it cannot be given here");
  }
}

/// Reads keywords into the options whose fields they name. Throws TypeError for a keyword that names none.
template <class Options>
Options options_of(const nb::dict& keywords) {
  Options options;
  std::size_t read = 0;
  Fields<Options>::visit(options, [&](const char* name, auto& field) {
    if (!keywords.contains(name)) return;
    ++read;
    read_keyword(name, keywords[name], field);
  });
  if (read == keywords.size()) return options;
  for (const auto& [key, value] : keywords) {
    const auto keyword = nb::cast<std::string>(key);
    bool known = false;
    Fields<Options>::visit(options, [&](const char* name, auto&) { known = known || keyword == name; });
    if (!known) throw nb::type_error(("unexpected keyword argument '" + keyword + "'").c_str());
  }
  return options;
}

}  // namespace meshgraft::python
