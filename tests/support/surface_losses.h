#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft::test {

/// What a repaired surface lacks of the given one. It is measured by positions alone, so that it needs no
/// report of the repair and holds for other libraries, too.
struct SurfaceLosses {
  Index vertices = 0;   ///< vertices of faces, at whose positions the repaired surface has none
  Index faces = 0;      ///< faces whose corners' positions no repaired face has, in either direction
  double area_rel = 0;  ///< their area over the area of the given surface
};

/// Non-finite vertices and faces with fewer than three positions are no losses.
SurfaceLosses surface_losses(const Mesh& given, const Mesh& repaired);

}  // namespace meshgraft::test
