#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <nanobind/nanobind.h>
#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/report.h>

#include "arrays.h"
#include "record_tables.h"

namespace meshgraft::python {

/// Returns the class of that name in one of the package's modules.
inline nb::object class_of(const char* module, const char* name) {
  return nb::module_::import_(module).attr(name);
}

/// Returns the mesh as the package's class Mesh.
nb::object to_python(Mesh mesh);

/// Returns the note as the package's class Note.
nb::object to_python(const Note& note);

namespace detail {

template <class T>
struct IsOptional : std::false_type {};
template <class T>
struct IsOptional<std::optional<T>> : std::true_type {};
template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

}  // namespace detail

/// Returns a value of the library as Python has it: records as dataclasses, words as strings, arrays of NumPy's
/// that own their memory.
template <class T>
nb::object to_python(const T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    return nb::bool_(value);
  } else if constexpr (Worded<T>) {
    for (const auto& word : Words<T>::list)
      if (word.value == value) return nb::str(word.name);
    return nb::none();
  } else if constexpr (std::is_integral_v<T>) {
    return nb::int_(value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return nb::float_(value);
  } else if constexpr (std::is_same_v<T, std::string>) {
    return nb::str(value.c_str(), value.size());
  } else if constexpr (std::is_same_v<T, std::string_view>) {
    return nb::str(value.data(), value.size());
  } else if constexpr (std::is_same_v<T, std::filesystem::path>) {
    return class_of("pathlib", "Path")(value.string());
  } else if constexpr (std::is_same_v<T, Method>) {
    return to_python(to_string(value));
  } else if constexpr (std::is_same_v<T, IndexMap>) {
    return array_of(value.new_index);
  } else if constexpr (std::is_same_v<T, Eigen::Affine3d>) {
    return array_of(Eigen::Matrix<double, 4, 4, Eigen::RowMajor>(value.matrix()));
  } else if constexpr (std::is_same_v<T, Eigen::Matrix3d>) {
    return array_of(Eigen::Matrix<double, 3, 3, Eigen::RowMajor>(value));
  } else if constexpr (std::is_same_v<T, Eigen::RowVector3d>) {
    return array_of(Eigen::Vector3d(value.transpose()));
  } else if constexpr (std::is_same_v<T, Flags>) {
    return array_of(value).attr("astype")("bool");
  } else if constexpr (std::is_same_v<T, std::vector<EdgePoint>>) {
    std::vector<Index> start, end;
    std::vector<double> t;
    for (const EdgePoint& point : value) {
      start.push_back(point.from);
      end.push_back(point.to);
      t.push_back(point.t);
    }
    return class_of("meshgraft._records", "EdgePoints")(nb::arg("start") = array_of(std::move(start)),
                                                        nb::arg("end") = array_of(std::move(end)),
                                                        nb::arg("t") = array_of(std::move(t)));
  } else if constexpr (detail::IsOptional<T>::value) {
    return value ? to_python(*value) : nb::object(nb::none());
  } else if constexpr (detail::IsVector<T>::value) {
    using Element = typename T::value_type;
    if constexpr (std::is_arithmetic_v<Element> && !std::is_same_v<Element, bool> &&
                  !std::is_same_v<Element, std::size_t>) {
      return array_of(value);
    } else {
      nb::list list;
      for (const Element& element : value) list.append(to_python(element));
      return nb::tuple(list);
    }
  } else if constexpr (Recorded<T>) {
    nb::dict fields;
    Fields<T>::visit(value, [&](const char* name, const auto& field) { fields[name] = to_python(field); });
    return class_of("meshgraft._records", Fields<T>::name)(**fields);
  } else {
    return array_of(value);
  }
}

}  // namespace meshgraft::python
