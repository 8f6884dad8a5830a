#include "memory_budget.h"

#include <meshgraft/core/error.h>

#include "core/facts.h"
#include "memory.h"

namespace meshgraft {

MemoryBudget::MemoryBudget(const Context& context)
    : MemoryBudget(context.memory > 0 ? context.memory : available_memory() / 4 * 3) {}

void MemoryBudget::charge(std::uint64_t bytes) {
  if (bytes > left()) {
    const auto megabytes = [](std::uint64_t count) { return count / 1'000'000; };
    throw Error(facts::core::OverBudget{.megabytes = megabytes(charged_) + megabytes(bytes) + 1,
                                        .allowed = megabytes(allowed_)});
  }
  charged_ += bytes;
}

}  // namespace meshgraft
