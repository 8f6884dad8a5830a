#include <meshgraft/core/context.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"

namespace meshgraft {

void Context::step(std::string_view stage, double fraction) const {
  throw_if_stopped();
  if (progress) progress({.stage = stage, .fraction = fraction});
}

void Context::throw_if_stopped() const {
  if (stop_token.stop_requested()) throw Error(facts::core::Cancelled{});
}

}  // namespace meshgraft
