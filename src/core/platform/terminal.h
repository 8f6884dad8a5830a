#pragma once

namespace meshgraft::platform {

/// Whether a person at a terminal sees what is printed to standard error.
bool stderr_is_terminal();

}  // namespace meshgraft::platform
