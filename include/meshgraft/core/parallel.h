#pragma once

#include <cstddef>
#include <functional>

#include <meshgraft/core/context.h>

namespace meshgraft {

/// Runs `body(begin, end)` over disjoint blocks that cover [0, count), on at most `context.threads` threads.
/// Each index must write only its own results and reduce nothing across indices: then the outcome does not
/// depend on the number of threads. Checks for cancellation between blocks; exceptions propagate.
void parallel_blocks(std::size_t count, const std::function<void(std::size_t, std::size_t)>& body,
                     const Context& context = {}, std::size_t grain = 512);

}  // namespace meshgraft
