#pragma once

#include <algorithm>
#include <cstddef>

#include <tbb/global_control.h>
#include <tbb/info.h>

namespace meshgraft {

/// Keeps one core free of the helper threads of loops while it exists. A loop that runs already gives the core
/// back between two of its tasks. On one core it has no effect.
class ReservedCore {
 private:
  tbb::global_control limit_{tbb::global_control::max_allowed_parallelism,
                             static_cast<std::size_t>(std::max(1, tbb::info::default_concurrency() - 1))};
};

}  // namespace meshgraft
