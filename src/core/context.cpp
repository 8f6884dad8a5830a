#include <meshgraft/core/context.h>

#include <meshgraft/core/error.h>

#include "core/facts.h"

namespace meshgraft {

void Context::step(std::string_view stage, double fraction) const {
  throw_if_stopped();
  if (progress) progress({.stage = stage, .fraction = fraction});
}

Context Context::within(std::string_view task, int number, int count) const {
  Context inner = *this;
  if (!progress) return inner;
  inner.progress = [outer = progress, task, number, count](Progress told) {
    told.within = task;
    told.number = number;
    told.count = count;
    outer(told);
  };
  return inner;
}

void Context::throw_if_stopped() const {
  if (stop_token.stop_requested()) throw Error(facts::core::Cancelled{});
}

}  // namespace meshgraft
