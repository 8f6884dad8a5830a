#pragma once

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/report.h>

namespace meshgraft::cli {

/// Prints what an edit did, for people: its inputs, its steps, the quality of what was deformed (against
/// `rest`), the files that were written.
void print_summary(const EditReport& report, const Points& rest);

}  // namespace meshgraft::cli
