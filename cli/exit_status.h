#pragma once

#include <meshgraft/core/error.h>

namespace meshgraft::cli {

/// Returns the exit status of the program for a code: usage 2, input 3, unsolvable 4, io 5, memory 6,
/// cancelled 130, internal 70.
int exit_status(ErrorCode code) noexcept;

}  // namespace meshgraft::cli
