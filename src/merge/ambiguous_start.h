#pragma once

#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>

namespace meshgraft {

/// Returns the fact merge.ambiguous_start about ambiguous pairs, at least one. `ambiguous_starts` reads it.
Fact ambiguous_start_fact(const std::vector<AmbiguousStart>& starts);

}  // namespace meshgraft
