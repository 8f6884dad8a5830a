#include "memory_budget.h"

#include <algorithm>

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "memory.h"

namespace meshgraft {

MemoryBudget::MemoryBudget(const Context& context)
    : MemoryBudget(context.memory > 0 ? context.memory : available_memory() / 4 * 3) {}

void MemoryBudget::charge(std::uint64_t bytes) {
  require(bytes);
  charged_ += bytes;
  peak_ = std::max(peak_, charged_);
}

void MemoryBudget::require(std::uint64_t bytes) const {
  if (bytes <= allowed_ - charged_) return;
  constexpr std::uint64_t megabyte = 1'000'000;
  const std::uint64_t rest = charged_ % megabyte + bytes % megabyte;  // the sum of both might overflow
  throw Error(facts::core::OverBudget{
      .megabytes = charged_ / megabyte + bytes / megabyte + (rest + megabyte - 1) / megabyte,
      .allowed = allowed_ / megabyte});
}

}  // namespace meshgraft
