#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/seam.h>

#include "seam_patch.h"

namespace meshgraft {

/// Smooths the band around the strips of a joined mesh, in place. Returns the vertices that it could move.
std::vector<Index> smooth_band(Mesh& mesh, const SeamLayout& layout, const SeamOptions& options,
                               const Context& context);

}  // namespace meshgraft
