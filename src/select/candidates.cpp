#include "candidates.h"

namespace meshgraft {

std::vector<Index> candidates_of(const SelectionMesh& context) {
  std::vector<Index> candidates;
  for (Index v = 0; v < context.mesh.vertex_count(); ++v)
    if (context.components[v] >= 0 && context.mesh.positions.row(v).allFinite()) candidates.push_back(v);
  return candidates;
}

}  // namespace meshgraft
