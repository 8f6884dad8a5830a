#pragma once

#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <meshgraft/core/error.h>

namespace meshgraft::test {

/// Runs `call`, which must throw Error with this code and a message that contains all of `words`.
template <class Call>
Error expect_error(const Call& call, ErrorCode code, const std::vector<std::string>& words) {
  try {
    call();
  } catch (const Error& error) {
    EXPECT_EQ(to_string(error.code()), to_string(code)) << error.what();
    for (const std::string& word : words) {
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos)
          << "no '" << word << "' in: " << error.what();
    }
    return error;
  }
  ADD_FAILURE() << "nothing was thrown";
  return Error(ErrorCode::internal, "nothing was thrown");
}

}  // namespace meshgraft::test
