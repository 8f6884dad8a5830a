#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/topology.h>

#include "seam_patch.h"

namespace meshgraft {

/// Slides vertices along the surface until the strips' triangles are well shaped: none inverted, and angles
/// of about 17° or more. Minimises Σ max(0, q - r)² over the triangles, one vertex after another. q is the
/// harmonic index (Σ of the angles' cotangents, the measure by which strips are chosen). r is the largest
/// accepted index: a constant; off the strips, the triangle's initial index where that is larger. Nothing
/// moves where no triangle exceeds its bound. `vertex_triangles`: of the patch's triangles; `may_slide`: per
/// vertex.
void relax_seam(Points& points, const SeamPatch& patch, const IndexLists& vertex_triangles,
                const Flags& may_slide, const Context& context);

}  // namespace meshgraft
