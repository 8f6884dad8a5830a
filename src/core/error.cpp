#include <meshgraft/core/error.h>

#include <exception>
#include <filesystem>
#include <new>
#include <utility>

namespace meshgraft {

namespace {

std::string compose(const std::string& problem, const std::string& location, const std::string& remedy) {
  std::string message = location.empty() ? problem : location + ": " + problem;
  if (!remedy.empty()) message += ". " + remedy;
  return message;
}

}  // namespace

int exit_status(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::usage: return 2;
    case ErrorCode::input: return 3;
    case ErrorCode::unsolvable: return 4;
    case ErrorCode::io: return 5;
    case ErrorCode::memory: return 6;
    case ErrorCode::cancelled: return 130;
    case ErrorCode::internal: return 70;
  }
  return 70;
}

std::string_view to_string(ErrorCode code) noexcept {
  switch (code) {
    case ErrorCode::usage: return "usage";
    case ErrorCode::input: return "input";
    case ErrorCode::unsolvable: return "unsolvable";
    case ErrorCode::io: return "io";
    case ErrorCode::memory: return "memory";
    case ErrorCode::cancelled: return "cancelled";
    case ErrorCode::internal: return "internal";
  }
  return "internal";
}

Error::Error(ErrorCode code, std::string problem, std::string location, std::string remedy)
    : std::runtime_error(compose(problem, location, remedy)),
      code_(code),
      problem_(std::move(problem)),
      location_(std::move(location)),
      remedy_(std::move(remedy)) {}

Error Error::within(std::string_view outer) const {
  std::string location(outer);
  if (!location_.empty()) location += ": " + location_;
  return Error(code_, problem_, location, remedy_);
}

Error current_error() {
  try {
    throw;
  } catch (const Error& error) {
    return error;
  } catch (const std::bad_alloc&) {
    return {
        ErrorCode::memory, "there is not enough memory", {}, "Close other programs, or take a smaller mesh"};
  } catch (const std::filesystem::filesystem_error& error) {
    return {ErrorCode::io, error.code().message(), error.path1().string()};
  } catch (const std::exception& error) {
    return {ErrorCode::internal, error.what(), {}, "This is a defect of meshgraft; please report it"};
  }
}

}  // namespace meshgraft
