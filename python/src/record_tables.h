#pragma once

namespace meshgraft::python {

/// A value of an enumeration and its word in Python.
template <class Enum>
struct Word {
  Enum value;
  const char* name;
};

/// The words of an enumeration: `list`. Specialised in the generated records.h.
template <class Enum>
struct Words;

/// The fields of a struct that Python knows as a dataclass or as keywords: `name` and `visit(record, visit)`,
/// which calls `visit(field name, field)` for each. Specialised in the generated records.h.
template <class Record>
struct Fields;

template <class T>
concept Worded = requires { Words<T>::list; };

template <class T>
concept Recorded = requires { Fields<T>::name; };

}  // namespace meshgraft::python
