#pragma once

#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>

namespace meshgraft {

/// Returns the fact merge.open_start about ambiguous pairs, at least one. `open_starts` reads it.
Fact open_start_fact(const std::vector<OpenStart>& starts);

}  // namespace meshgraft
