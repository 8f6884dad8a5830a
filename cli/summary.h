#pragma once

#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/report.h>

namespace meshgraft::cli {

/// Prints a summary of an edit: its inputs, its steps, the quality of the deformed mesh (against `rest`), and
/// the written files.
void print_summary(const EditFile& edit, const EditReport& report, const Points& rest);

}  // namespace meshgraft::cli
