#pragma once

#include <string>
#include <string_view>

#include <meshgraft/core/error.h>

namespace meshgraft::distributed {

/// Returns an error as text, to send it to another rank, and the error of such a text. Notes are kept.
std::string text_of_error(const Error& error);
Error error_of_text(std::string_view text);

}  // namespace meshgraft::distributed
