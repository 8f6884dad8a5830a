#pragma once

#include <optional>
#include <string_view>

#include <meshgraft/mesh/mesh.h>

#include "mesh/up_axis.h"

namespace meshgraft::io {

/// Returns the axis that a comment names in the form "Vertical axis: z", in whatever case. Other programs
/// write it, too.
std::optional<UpAxis> up_axis_in(std::string_view comment);

/// Returns the axis that one of the comments of a text names. Comments begin with '#' and end with their line.
/// `only_leading`: the first line that is neither blank nor a comment ends the search.
std::optional<UpAxis> up_axis_in_text(std::string_view text, bool only_leading);

/// Returns the comment for a mesh with z up in a format whose files have y up unless they say so. It is empty
/// for other meshes.
std::string_view up_axis_comment(const Mesh& mesh);

}  // namespace meshgraft::io
