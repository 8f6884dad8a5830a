#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

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

/// The exception type of the library. A message has up to three parts, joined as
/// "location: problem. remedy.".
class Error : public std::runtime_error {
 public:
  /// `problem` is a clause without a final full stop. `location` is a file, line, field or element; `remedy`
  /// says what the reader can do. Both may be empty.
  Error(ErrorCode code, std::string problem, std::string location = {}, std::string remedy = {});

  ErrorCode code() const noexcept { return code_; }
  const std::string& problem() const noexcept { return problem_; }
  const std::string& location() const noexcept { return location_; }
  const std::string& remedy() const noexcept { return remedy_; }

  /// Returns the same error with `outer` put before its location: "outer: inner location".
  Error within(std::string_view outer) const;

 private:
  ErrorCode code_;
  std::string problem_;
  std::string location_;
  std::string remedy_;
};

/// Returns the exception that is being handled as an Error. An Error is returned as it is. Lack of memory has
/// the code memory, an error of the file system io, all others internal. Must be called in a catch block.
Error current_error();

}  // namespace meshgraft
