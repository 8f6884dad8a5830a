#pragma once

#include <cstddef>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace meshgraft {

enum class ErrorCode;

/// Kinds of values that a field of a fact may have. A text comes from the user's data; a word is an identifier
/// of a closed list.
enum class FieldKind { integer, number, text, integers, numbers, texts, word };

/// A value of a field. The alternatives are in the order of FieldKind; a word is a string.
using FieldValue = std::variant<std::int64_t, double, std::string, std::vector<std::int64_t>,
                                std::vector<double>, std::vector<std::string>>;

/// A word that a field of the kind `word` may have.
struct FieldWord {
  std::string_view name;  ///< stable identifier, e.g. "write"
  std::string_view text;  ///< the word in the library's sentences, e.g. "written"
};

/// A field of a fact.
struct FieldType {
  std::string_view name;
  FieldKind kind;
  std::span<const FieldWord> words{};  ///< all that a field of the kind `word` may have
};

/// A type of fact: one row of a layer's table (src/LAYER/facts.json). docs/facts.md lists all of them.
struct FactType {
  std::string_view id;            ///< stable name, "layer.cause", e.g. "merge.no_such_vertex"
  std::optional<ErrorCode> code;  ///< code of the errors of this type; none for notes
  std::span<const FieldType> fields;
  /// Sentence in the terms of the library: the problem of an error, the text of a note. "{name}" stands for the
  /// value of a field.
  std::string_view text;
  std::string_view remedy;  ///< what the caller can do, with fields likewise; may be empty
};

/// Holds the content of an error or a note without a sentence: a type and the values of its fields. A front end
/// (command line, editor) words facts in its own terms (`fill_in`). The texts here are those of the library.
class Fact {
 public:
  /// `values` are in the order of the type's fields. `type` must outlive the fact; the tables' types always
  /// do.
  Fact(const FactType& type, std::vector<FieldValue> values) : type_(&type), values_(std::move(values)) {}

  const FactType& type() const noexcept { return *type_; }
  std::string_view id() const noexcept { return type_->id; }
  /// Returns the values, in the order of `type().fields`.
  const std::vector<FieldValue>& values() const noexcept { return values_; }
  /// Returns the value of the field with this name and kind. Throws std::out_of_range if there is none.
  template <class T>
  const T& get(std::string_view field) const {
    return std::get<T>(value(field));
  }
  const FieldValue& value(std::string_view field) const;

  /// Returns the library's sentence and remedy with the values filled in.
  std::string text() const;
  std::string remedy() const;

  friend bool operator==(const Fact& a, const Fact& b) {
    return a.type_->id == b.type_->id && a.values_ == b.values_;
  }

 private:
  const FactType* type_;
  std::vector<FieldValue> values_;
};

/// A fact about a result that is no error.
using Note = Fact;

/// Returns `text` with each "{name}" or "{name:format}" replaced by the fact's field of this name. Formats are
/// those of the C++ standard library, and of integers "{n:face|faces}", which writes "1 face" or "3 faces".
/// Elements of a list are separated by ", ". A word is replaced by its text.
std::string fill_in(std::string_view text, const Fact& fact);

/// The text of a fact in the terms of an interface: the problem or the note, and what the reader can do, which
/// may be empty.
struct FactText {
  std::string statement, remedy;
};

/// Words facts in the terms of one interface of the product.
using Wording = std::function<FactText(const Fact&)>;

/// Words facts in the terms of the library: `Fact::text` and `Fact::remedy`.
FactText library_text(const Fact& fact);

/// Returns all types of facts that the library knows, in the order of their layers and ids.
std::span<const FactType* const> fact_types();

/// A part of a location.
struct LocationPart {
  enum class Kind {
    file,     ///< a file or a named part of one, by its name: "edit.json"
    field,    ///< a field of a document or of options, by its name: "size"
    element,  ///< an element of a list, by its index from 0: "[2]"
    handle,   ///< a handle, by its name: "handle 'nose'"
    pair,     ///< a pair of boundary loops, by its index from 0: "pair 1"
    place,    ///< a place that is named by a text of its own: "line 3", "vertex 7"
  };
  Kind kind;
  std::string name{};     ///< of file, field, handle and place
  std::size_t index = 0;  ///< of element and pair

  friend bool operator==(const LocationPart&, const LocationPart&) = default;
};

/// Tells where an error is: parts from the outermost to the innermost, e.g. a file, a list of it, an element, a
/// field. It may be empty. A front end may rename or leave out parts before it shows them.
class Location {
 public:
  Location() = default;
  /// A field of options or of a document.
  Location(const char* field);
  /// A file.
  Location(const std::filesystem::path& file);

  static Location file(std::string name);
  static Location field(std::string name);
  static Location handle(std::string name);
  static Location pair(std::size_t index);
  static Location place(std::string text);

  /// Returns the location `inner` within this one.
  Location operator/(const Location& inner) const;
  /// Returns the element `index` of the list at this location.
  Location operator[](std::size_t index) const;
  /// Returns the parts from `first` on: the location within the first ones.
  Location from(std::size_t first) const;
  bool starts_with(const Location& outer) const;

  bool empty() const noexcept { return parts_.empty(); }
  const std::vector<LocationPart>& parts() const noexcept { return parts_; }
  /// Returns e.g. "edit.json: steps[2].handles[0].pose" or "edit.json: steps[2]: handle 'nose'".
  std::string text() const;

  friend bool operator==(const Location&, const Location&) = default;

 private:
  explicit Location(LocationPart part) { parts_.push_back(std::move(part)); }

  std::vector<LocationPart> parts_;
};

/// Kinds of errors. The library and all front ends use these codes.
enum class ErrorCode {
  usage,       ///< the call is malformed
  input,       ///< a file, a mesh or an option's value is not acceptable
  unsolvable,  ///< the input is well formed, but the edit it asks for has no unique or no finite solution
  io,          ///< reading or writing a file failed
  memory,      ///< the machine has too little memory for the call
  cancelled,   ///< the caller asked to stop
  internal,    ///< a bug in meshgraft
};

/// Returns the code's name in reports, e.g. "unsolvable".
std::string_view to_string(ErrorCode code) noexcept;

/// The exception type of the library: a fact and its location. Copies share what they hold and do not throw.
/// `what()` is "location: problem. remedy", in the terms of the library.
class Error : public std::exception {
 public:
  /// `fact` is of a type with a code.
  Error(Fact fact, Location location = {});

  const char* what() const noexcept override;
  ErrorCode code() const noexcept;
  const Fact& fact() const noexcept;
  /// Returns the id of the fact, e.g. "merge.no_such_vertex".
  std::string_view id() const noexcept { return fact().id(); }
  const Location& location() const noexcept;
  /// Notes that explain the error. `what()` ends with them.
  std::span<const Note> notes() const noexcept;
  std::string problem() const { return fact().text(); }
  std::string remedy() const { return fact().remedy(); }

  /// Returns the same error at another location.
  Error at(Location location) const;
  /// Returns the same error with `outer` put before its location.
  Error within(const Location& outer) const;
  /// Returns the same error with one more note.
  Error with(Note note) const;

 private:
  struct Data;
  std::shared_ptr<const Data> data_;
};

/// Returns "location: problem. remedy". Location and remedy may be empty.
std::string error_sentence(std::string_view location, std::string_view problem, std::string_view remedy);

/// Returns "location: problem. remedy", and after it the error's notes, in the words of an interface.
std::string sentence(const Error& error, const Wording& wording);

/// Returns "note. remedy" in the words of an interface.
std::string sentence(const Note& note, const Wording& wording);

/// Returns the exception that is being handled as an Error. An Error is returned as it is. Lack of memory has
/// the code memory, an error of the file system io, all others internal. Must be called in a catch block.
Error current_error();

}  // namespace meshgraft
