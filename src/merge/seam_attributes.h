#pragma once

#include <array>
#include <span>
#include <vector>

#include <meshgraft/merge/seam.h>

#include "seam_patch.h"

namespace meshgraft {

/// Names the groups of a joined mesh: faces without one become "target" or "source".
void label_sides(Mesh& mesh, const SeamLayout& layout);

/// Adds the triangles of a strip behind the faces. `neighbour`, per triangle: the target's face that it takes
/// its face attributes from (the material), but for its group, "seam". Its corner values (UVs) are missing.
void add_strip(Mesh& mesh, std::span<const std::array<Index, 3>> triangles, std::span<const Index> neighbour);

/// Writes normals where there are any: turned where the band moved, new ones on and around the strips.
void renew_normals(Mesh& mesh, const SeamLayout& layout, const Points& unsmoothed);

}  // namespace meshgraft
