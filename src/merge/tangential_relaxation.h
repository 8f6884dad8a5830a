#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

#include "seam_patch.h"

namespace meshgraft {

/// Slides vertices along the surface until the strips' triangles are well shaped: none turned over, and angles
/// of about 17° or more. Lowers Σ max(0, q - r)² over the triangles, one vertex after another; q is the
/// harmonic index (Σ of the angles' cotangents, the measure by which strips are chosen), r what a triangle may
/// have: a bound, or off the strips what it came with. Where all is well, nothing moves. `vertex_triangles`: of
/// the patch's triangles; `may_slide`: per vertex.
void relax_tangentially(Points& points, const SeamPatch& patch, const IndexLists& vertex_triangles,
                        const Flags& may_slide, const Context& context);

}  // namespace meshgraft
