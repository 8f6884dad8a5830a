#pragma once

#include <optional>
#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "pair_geometry.h"

namespace meshgraft {

/// Returns the source's positions with each connected component near its final pose, because the graft must
/// not depend on the source's pose. The pose is the similarity that fits the component's loops best, with the
/// scale `size` if that is given. Moves the source loops in `pairs` along.
Points pose_by_boundary(const Points& source, const std::vector<Index>& component,
                        std::vector<PairGeometry>& pairs, std::span<const Correspondence> correspondences,
                        std::optional<double> size);

}  // namespace meshgraft
