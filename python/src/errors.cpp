#include "errors.h"

#include <algorithm>
#include <exception>
#include <ranges>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <variant>

#include "python/facts.h"

namespace meshgraft::python {

namespace {

struct OwnText {
  std::string_view id, text, remedy;
};

constexpr OwnText own_texts[] = {
#include "python/texts.inc"
};

nb::dict fields_of(const Fact& fact) {
  nb::dict fields;
  for (std::size_t i = 0; i < fact.values().size(); ++i)
    fields[nb::str(fact.type().fields[i].name.data(), fact.type().fields[i].name.size())] =
        std::visit([](const auto& value) -> nb::object { return to_python(value); }, fact.values()[i]);
  return fields;
}

/// Returns the name of the innermost file of a location, or None.
nb::object innermost_file(const Location& location) {
  const auto parts = location.parts() | std::views::reverse;
  const auto file = std::ranges::find(parts, LocationPart::Kind::file, &LocationPart::kind);
  return file == parts.end() ? nb::none() : to_python(file->name);
}

}  // namespace

FactText text_of(const Fact& fact) {
  const OwnText* own = std::ranges::lower_bound(own_texts, fact.id(), {}, &OwnText::id);
  if (own == std::end(own_texts) || own->id != fact.id()) return {fact.text(), fact.remedy()};
  return {fill_in(own->text, fact), fill_in(own->remedy, fact)};
}

nb::object to_python(const Note& note) {
  const FactText text = text_of(note);
  return class_of("meshgraft._facts", "Note")(
      nb::arg("id") = to_python(note.id()), nb::arg("fields") = fields_of(note),
      nb::arg("text") = to_python(text.statement), nb::arg("remedy") = to_python(text.remedy));
}

nb::object exception_of(const Error& error) {
  const FactText text = text_of(error.fact());
  nb::list notes;
  for (const Note& note : error.notes()) notes.append(to_python(note));
  return class_of("meshgraft._facts", "make_error")(
      to_python(to_string(error.code())), to_python(error.id()), fields_of(error.fact()),
      to_python(error.location().text()), to_python(text.statement), to_python(text.remedy), nb::tuple(notes),
      to_python(sentence(error, text_of)), innermost_file(error.location()));
}

void translate_errors() {
  nb::register_exception_translator([](const std::exception_ptr& pointer, void*) {
    const auto set = [](const Error& error) {
      const nb::object exception = exception_of(error);
      PyErr_SetObject(reinterpret_cast<PyObject*>(Py_TYPE(exception.ptr())), exception.ptr());
    };
    try {
      std::rethrow_exception(pointer);
    } catch (const Error& error) {
      set(error);
    } catch (const std::bad_cast&) {
      PyErr_SetString(PyExc_ValueError, "a text is not valid Unicode, or a value is of another type");
    } catch (const std::logic_error&) {
      set(current_error());  // a bug
    }
  });
}

}  // namespace meshgraft::python
