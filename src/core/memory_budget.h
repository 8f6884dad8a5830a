#pragma once

#include <cstdint>

#include <meshgraft/core/context.h>

namespace meshgraft {

/// The memory that reading a file may take. A reader charges what it is about to allocate for the content of
/// the file, so that a small file that unpacks to more than the machine holds is refused before the memory is
/// taken.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t bytes) : allowed_(bytes) {}
  /// Takes the size from the context.
  explicit MemoryBudget(const Context& context);

  /// Throws Error(memory), core.over_budget, if the bytes charged so far exceed the budget.
  void charge(std::uint64_t bytes);
  std::uint64_t left() const { return allowed_ - charged_; }

 private:
  std::uint64_t allowed_;
  std::uint64_t charged_ = 0;
};

}  // namespace meshgraft
