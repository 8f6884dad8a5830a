#pragma once

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Turns every face over: corners in reverse order (each face keeps its first one), corner values along, and
/// attributes called "normal" or `cut_normal_name` to the other side. The result has no source document.
Mesh turned_over(const Mesh& mesh);

/// Volume that a surface encloses when each boundary loop is closed by a fan, over that of a ball of its area:
/// positive where its faces look outward. 0 where that cannot be told: the openings are wider than half of the
/// surface (a sheet, a dent).
double enclosed_volume(const Mesh& mesh);

}  // namespace meshgraft
