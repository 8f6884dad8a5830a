#include "session.h"

#include <chrono>

namespace meshgraft::editor {

using namespace std::chrono_literals;

void Retirement::take(std::unique_ptr<Worker> worker) {
  const std::lock_guard lock(mutex_);
  std::erase_if(ending_,
                [](const std::future<void>& one) { return one.wait_for(0s) == std::future_status::ready; });
  ending_.push_back(std::async(std::launch::async, [ending = std::move(worker)]() mutable { ending.reset(); }));
}

}  // namespace meshgraft::editor
