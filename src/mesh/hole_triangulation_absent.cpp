#include <meshgraft/mesh/repair.h>

#include "hole_triangulation.h"

namespace meshgraft {

bool can_fill_holes() { return false; }

std::vector<std::array<Index, 3>> triangulate_hole(const Points&, const Points&) { return {}; }

}  // namespace meshgraft
