#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// A `.sel` file of the standard deformation tests: one number per vertex, 0 fixed, 1 free, 2 handle.
struct SelRoles {
  std::vector<Index> fixed, free, handle;
};

/// Parses the text of a `.sel` file; `#` starts a comment. Throws Error(input) with `location` and the line
/// for anything but 0, 1 or 2, and for a count that differs from the mesh's (io.fewer_states_than_vertices,
/// io.more_states_than_vertices).
SelRoles parse_sel(std::string_view text, Index vertex_count, const Location& location);

/// Parses vertex indices (from 0) separated by white space, and returns them in their order. `#` starts a
/// comment, and repeated indices are dropped. Throws Error(input) with `location` and the line for anything
/// else and for an index out of range.
std::vector<Index> parse_indices(std::string_view text, Index vertex_count, const Location& location);

/// Parses a `.def` file: an affine 4×4 matrix as 16 numbers, row by row; `#` starts a comment. Throws
/// Error(input) with `location` and the line for anything else, for a non-finite number, and for a last row
/// other than 0 0 0 1.
Eigen::Matrix4d parse_def(std::string_view text, const Location& location);

}  // namespace meshgraft
