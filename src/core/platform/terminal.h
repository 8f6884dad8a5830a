#pragma once

namespace meshgraft::platform {

/// Returns whether standard error is a terminal, where a person sees the output.
bool stderr_is_terminal();

}  // namespace meshgraft::platform
