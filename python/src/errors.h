#pragma once

#include <nanobind/nanobind.h>

#include <meshgraft/core/error.h>

#include "to_python.h"

namespace meshgraft::python {

/// Words facts as Python's users read them: the library's own sentences, or those of python/texts.json.
FactText text_of(const Fact& fact);

/// Returns the error as an exception of the package, of the class that its code has.
nb::object exception_of(const Error& error);

/// Lets the library's errors reach Python as exceptions of the package.
void translate_errors();

}  // namespace meshgraft::python
