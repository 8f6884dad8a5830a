#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "seam_patch.h"

namespace meshgraft {

/// The loops on both sides of one strip, as vertices of the joined mesh.
struct StripLoops {
  std::vector<Index> target, source;
};

/// Gives the source the colours of the target's loops: the mean of their vertices, weighted by the inverse
/// square of the distance. Near a loop that is its own colour.
void colour_source_like_target(Mesh& mesh, const SeamLayout& layout, const std::vector<StripLoops>& strips,
                               const Context& context);

/// Mixes the vertex colours of both sides within a length along edges from the strips (model units). At a
/// strip each side has half of the other's colour, extended from the other's loops as above.
void blend_colours(Mesh& mesh, const SeamLayout& layout, const std::vector<StripLoops>& strips, double length,
                   const Context& context);

}  // namespace meshgraft
