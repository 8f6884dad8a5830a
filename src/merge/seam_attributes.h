#pragma once

#include <array>
#include <span>
#include <vector>

#include "seam.h"
#include "seam_patch.h"

namespace meshgraft {

/// Names the groups of a joined mesh: faces without a group get "target" or "source".
void label_sides(Mesh& mesh, const SeamLayout& layout);

/// Appends the triangles of a strip to the faces. `neighbour`, per triangle: the target's face whose face
/// attributes (the material) it copies. Its group is "seam". Its corner values (UVs) are missing at first.
void add_strip(Mesh& mesh, std::span<const std::array<Index, 3>> triangles, std::span<const Index> neighbour);

/// Updates normals where the mesh has any: rotated where the band moved, recomputed on and around the strips.
void renew_normals(Mesh& mesh, const SeamLayout& layout, const Points& unfaired);

}  // namespace meshgraft
