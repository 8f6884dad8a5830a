#pragma once

#include <memory>

#include <meshgraft/mesh/diagnostics.h>

#include "simple_surface.h"

namespace meshgraft {

/// The findings of `check_mesh`, and the connectivity that it found on the way.
struct CheckedSurface {
  Diagnostics diagnostics;
  std::shared_ptr<const SimpleSurface> surface;  ///< null if the mesh is not a simple surface
};

/// Does what `check_mesh` does.
CheckedSurface check_surface(const Mesh& mesh, const Context& context = {});

}  // namespace meshgraft
