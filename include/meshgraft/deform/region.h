#pragma once

#include <vector>

#include <meshgraft/deform/constraints.h>
#include <meshgraft/deform/handle.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// The vertices of a mesh that move, stay fixed or are held, by their roles.
struct Region {
  std::vector<Index> vertices{};  ///< the region of interest; unused if `whole` is set
  bool whole = false;             ///< the region is the whole mesh
  std::vector<Index> fixed{};     ///< vertices of the region that are fixed (rest position, transform I)
  std::vector<Handle> handles{};  ///< disjoint from each other and from `fixed`
  std::vector<Anchor> anchors{};
  std::vector<Feature> features{};
};

}  // namespace meshgraft
