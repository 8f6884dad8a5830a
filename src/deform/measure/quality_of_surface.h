#pragma once

#include <meshgraft/deform/quality.h>

#include "mesh/simple_surface.h"

namespace meshgraft {

/// Returns what `measure_quality` does, for a mesh whose triangles are the faces of `surface`, in their order.
Quality measure_quality(const EditedMesh& mesh, const SimpleSurface& surface, const QualityOptions& options,
                        const Context& context = {});

}  // namespace meshgraft
