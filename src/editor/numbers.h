#pragma once

#include <atomic>
#include <cstdint>

namespace meshgraft::editor {

/// Numbers that identify meshes and grafts to pages. No number is used twice, so that a page never confuses
/// data of an earlier document with data of the next one.
class Numbers {
 public:
  std::int64_t next() const { return ++last_; }

 private:
  mutable std::atomic<std::int64_t> last_ = 0;
};

}  // namespace meshgraft::editor
