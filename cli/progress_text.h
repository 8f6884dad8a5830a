#pragma once

#include <string>

#include <meshgraft/core/context.h>

namespace meshgraft::cli {

/// Words progress for people: "TASK (NUMBER of COUNT): STAGE". Absent parts are left out.
std::string progress_text(const Progress& progress);

}  // namespace meshgraft::cli
