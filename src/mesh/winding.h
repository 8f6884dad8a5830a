#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Returns the mesh with the orientation of every face reversed. Corners are in reverse order (each face
/// keeps its first one), with their corner values. Attributes called "normal" or `cut_normal_name` are
/// negated. The result has no source document.
Mesh turned_over(const Mesh& mesh);

/// Returns the volume that a surface encloses, divided by that of a ball with the same area. Each boundary
/// loop is first closed by a fan. The result is positive where the faces look outward. It is 0 where that is
/// undecided, because the openings are wider than half of the surface (a sheet, a dent).
double enclosed_volume(const Mesh& mesh);

}  // namespace meshgraft
