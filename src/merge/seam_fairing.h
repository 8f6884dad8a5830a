#pragma once

#include <vector>

#include <meshgraft/core/context.h>

#include "seam.h"
#include "seam_patch.h"

namespace meshgraft {

/// Fairs the band around the strips of a joined mesh, in place, by the method of the options. By
/// `FairingMethod::curvature`, vertices move along their normals until the curvature continues across the
/// strips from both surfaces (a thin plate with details, after Botsch & Kobbelt 2004). Returns the vertices
/// that may move, ascending.
std::vector<Index> fair_seam(Mesh& mesh, const SeamLayout& layout, const SeamOptions& options,
                             const Context& context);

}  // namespace meshgraft
