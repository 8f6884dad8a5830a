#pragma once

#include <cstdint>

#include <meshgraft/core/context.h>

namespace meshgraft {

/// The memory that reading a file may take: the file's bytes, the mesh, and everything on the way. A reader
/// charges each allocation of a size that the file decides, before it allocates, and releases what it frees. So
/// a file that takes too much is refused before the memory is taken.
class MemoryBudget {
 public:
  explicit MemoryBudget(std::uint64_t bytes) : allowed_(bytes) {}
  /// Takes the size from the context.
  explicit MemoryBudget(const Context& context);

  /// Throws Error(memory), core.over_budget, if `bytes` more exceed the budget.
  void charge(std::uint64_t bytes);
  /// Takes back a charge for memory that has been freed.
  void release(std::uint64_t bytes) { charged_ -= bytes; }
  /// Throws what `charge` would throw, but charges nothing. It refuses a file early that needs at least this
  /// much later.
  void require(std::uint64_t bytes) const;

  std::uint64_t charged() const { return charged_; }
  /// Returns the largest sum of charges at any time so far.
  std::uint64_t peak() const { return peak_; }

 private:
  std::uint64_t allowed_;
  std::uint64_t charged_ = 0, peak_ = 0;
};

}  // namespace meshgraft
