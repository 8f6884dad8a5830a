#pragma once

#include <vector>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>

namespace meshgraft {

/// Returns the notes on a finished merge: what its report says of loops, source and result that a user should
/// know.
std::vector<Note> merge_notes(const MergeReport& report, const MergeOptions& options);

/// Returns the source's scale relative to the given size, or to the least that one of its loops asks for.
/// Returns 1 for a source whose pose is kept.
double relative_scale(const MergeReport& report, const MergeOptions& options);

}  // namespace meshgraft
