#pragma once

#include <atomic>
#include <cstdint>

namespace meshgraft::editor {

/// What pages know meshes and grafts by. None comes twice, so that what a page keeps of a document that it had
/// open is never taken for something of the next one.
class Numbers {
 public:
  std::int64_t next() const { return ++last_; }

 private:
  mutable std::atomic<std::int64_t> last_ = 0;
};

}  // namespace meshgraft::editor
