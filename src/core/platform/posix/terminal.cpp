#include "core/platform/terminal.h"

#include <unistd.h>

namespace meshgraft::platform {

bool stderr_is_terminal() { return ::isatty(STDERR_FILENO) != 0; }

}  // namespace meshgraft::platform
