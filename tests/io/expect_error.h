#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

namespace meshgraft::test {

/// Runs `call`, which must throw Error with a message that contains all of `words`.
template <class Call>
Error expect_error(const Call& call, const std::vector<std::string>& words) {
  try {
    call();
  } catch (const Error& error) {
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "no '" << word << "' in: " << error.what();
    }
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  static constexpr FactType nothing{"test.nothing", ErrorCode::internal, {}, "nothing was thrown", ""};
  return Error(Fact(nothing, {}));
}

/// The same for an Error with this code.
template <class Call>
Error expect_error(const Call& call, ErrorCode code, const std::vector<std::string>& words) {
  const Error error = expect_error(call, words);
  EXPECT_EQ(to_string(error.code()), to_string(code)) << error.what();
  return error;
}

/// The same for an Error with this id.
template <class Call>
Error expect_error(const Call& call, std::string_view id, const std::vector<std::string>& words) {
  const Error error = expect_error(call, words);
  EXPECT_EQ(error.id(), id) << error.what();
  return error;
}

}  // namespace meshgraft::test
