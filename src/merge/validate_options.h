#pragma once

#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Throws Error(input), naming the option, for a value out of range and for options that exclude each other.
void validate_options(const MergeOptions& options, const Mesh& source, const Mesh& target);

}  // namespace meshgraft
