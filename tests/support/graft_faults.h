#pragma once

#include <string>
#include <vector>

#include <meshgraft/merge/merge.h>

#include "support/random_grafts.h"

namespace meshgraft::test {

/// Returns the faults in a result's topology, coordinates, faces and index maps, one text each. A valid result
/// has none.
std::vector<std::string> faults_of(const RandomGraft& graft, const MergeResult& result);

/// Counts of intersecting pairs of triangles in a result.
struct Intersections {
  Index new_ones = 0;  ///< pairs beyond those of target and source
  Index of_seam = 0;   ///< pairs with a triangle of the seam
};

Intersections intersections_of(const RandomGraft& graft, const MergeResult& result);

}  // namespace meshgraft::test
