#pragma once

#include <exception>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include <meshgraft/core/fact.h>

namespace meshgraft {

/// Kinds of errors. One table (`exit_status`) maps them to the exit status of the command line; the other
/// interfaces of the product use the same codes.
enum class ErrorCode {
  usage,       ///< the call or the command line is malformed
  input,       ///< a file, a mesh or an option's value is not acceptable
  unsolvable,  ///< the input is well formed, but the edit it asks for has no unique or no finite solution
  io,          ///< reading or writing a file failed
  memory,      ///< the machine has too little memory for the call
  cancelled,   ///< the caller asked to stop
  internal,    ///< a defect of meshgraft
};

/// Returns the process exit status for a code: usage 2, input 3, unsolvable 4, io 5, memory 6, cancelled 130,
/// internal 70.
int exit_status(ErrorCode code) noexcept;

/// Returns the code's name in reports, e.g. "unsolvable".
std::string_view to_string(ErrorCode code) noexcept;

/// The exception type of the library: a fact and its location. Copies share what they hold and do not throw.
/// `what()` is "location: problem. remedy", in the terms of the library.
class Error : public std::exception {
 public:
  /// `fact` is of a class of errors. `location` is a file, line, field or element, or empty.
  Error(Fact fact, std::string location = {});

  const char* what() const noexcept override;
  ErrorCode code() const noexcept;
  const Fact& fact() const noexcept;
  /// Returns the id of the fact, e.g. "merge.start_unclear".
  std::string_view id() const noexcept { return fact().id(); }
  const std::string& location() const noexcept;
  /// Notes that explain the error. `what()` ends with them.
  std::span<const Note> notes() const noexcept;
  std::string problem() const { return fact().text(); }
  std::string remedy() const { return fact().remedy(); }

  /// Returns the same error at another location.
  Error at(std::string location) const;
  /// Returns the same error with `outer` put before its location: "outer: inner location".
  Error within(std::string_view outer) const;
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
