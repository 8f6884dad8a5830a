#pragma once

#include <vector>

#include <meshgraft/deform/quality.h>
#include <meshgraft/mesh/mesh.h>

#include "communicator.h"
#include "local_mesh.h"

namespace meshgraft::distributed {

/// The own vertices of a rank in two states, both own × 3, and which of them an edit could move.
struct OwnVertices {
  const Points& rest;
  const Points& edited;
  const Flags& is_free;
};

/// Measures a deformation as `measure_quality` does, up to rounding, but for widths and intersections. `starts`
/// has where the ranks' vertices start. Any rank may have any triangle, but each triangle is at one rank.
Quality measure_shared_quality(const Communicator& comm, const std::vector<Number>& starts,
                               const std::vector<NumberedTriangle>& triangles, const OwnVertices& own);

}  // namespace meshgraft::distributed
