#pragma once

#include <stop_token>

#include "core/platform/interrupt.h"

namespace meshgraft::cli {

/// Turns Ctrl-C (and SIGTERM and SIGHUP) into a stop request. A second one ends the program at once.
class Interrupt {
 public:
  Interrupt();
  std::stop_token token() const { return source_.get_token(); }

 private:
  void stop();

  std::stop_source source_;
  platform::InterruptWatch watch_;
};

}  // namespace meshgraft::cli
