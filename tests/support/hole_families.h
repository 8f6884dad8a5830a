#pragma once

#include <array>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

/// Makes loops of holes in surfaces of many shapes, the same ones in every run.
namespace meshgraft::test {

struct HoleCase {
  std::string family;
  Points points;  ///< n×3, along the hole
  Points beyond;  ///< n×3, or 0×3: the third corner of the face beyond each edge

  Index size() const { return static_cast<Index>(points.rows()); }
  std::string name() const;  ///< "star, 20 edges, faces around it known"
};

/// Returns flat, star, sphere, saddle, cylinder, ragged, helix, scan.
const std::vector<std::string>& hole_family_names();

/// Returns a loop of `edges` edges. That of a scan is cut out of a built-in model and has only about as many.
HoleCase make_hole(const std::string& family, Index edges, bool with_beyond);

/// Returns all families with and without the faces around them, of 3 to `most_edges` edges. With 5,000 edges
/// these are 212 loops.
std::vector<HoleCase> hole_cases(Index most_edges);

/// The cost of a triangulation of a loop.
struct HoleCost {
  double angle = 0;  ///< largest angle between the normals of neighbours, radians
  double area = 0;
};

/// Measures the cost independently of the library's code. Triangles without area make no angle.
HoleCost hole_cost(const HoleCase& hole, const std::vector<std::array<Index, 3>>& triangles);

/// Returns the first fault of a triangulation, or "". A valid one has n − 2 triangles, each edge of the loop
/// once and along it, and each other edge once in either direction.
std::string hole_faults(Index loop_size, const std::vector<std::array<Index, 3>>& triangles);

}  // namespace meshgraft::test
