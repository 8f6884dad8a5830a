#include "interrupt.h"

#include <cstdio>
#include <cstdlib>

#include <meshgraft/core/error.h>

#include "core/platform/process.h"
#include "core/platform/terminal.h"
#include "exit_status.h"

namespace meshgraft::cli {

Interrupt::Interrupt() : watch_([this] { stop(); }) {
  platform::report_failed_writes();  // as errors, so that half-written files are removed
}

void Interrupt::stop() {
  if (!source_.request_stop()) std::_Exit(exit_status(ErrorCode::cancelled));
  if (platform::stderr_is_terminal())
    std::fputs("\nmeshgraft: stopping; press Ctrl-C again to stop at once\n", stderr);
}

}  // namespace meshgraft::cli
