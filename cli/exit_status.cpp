#include "exit_status.h"

namespace meshgraft::cli {

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

}  // namespace meshgraft::cli
