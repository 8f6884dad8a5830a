#pragma once

#include <array>
#include <string>
#include <vector>

#include <meshgraft/mesh/mesh.h>

/// Loops of holes in surfaces of many shapes, the same ones every time.
namespace meshgraft::test {

struct HoleCase {
  std::string family;
  Points points;  ///< n×3, along the hole
  Points beyond;  ///< n×3, or 0×3: the third corner of the face beyond each edge

  Index size() const { return static_cast<Index>(points.rows()); }
  std::string name() const;  ///< "star, 20 edges, faces around it known"
};

/// flat, star, sphere, saddle, cylinder, ragged, helix, scan.
const std::vector<std::string>& hole_family_names();

/// A loop of `edges` edges; a scan's, cut out of a built-in model, has only about as many.
HoleCase make_hole(const std::string& family, Index edges, bool with_beyond);

/// All families with and without the faces around them, of 3 to `most_edges` edges: 212 up to 5,000 edges.
std::vector<HoleCase> hole_cases(Index most_edges);

/// What a triangulation of a loop costs.
struct HoleCost {
  double angle = 0;  ///< the largest between the normals of neighbours, radians
  double area = 0;
};

/// Measured independently of what makes triangulations. A triangle without area makes no angle.
HoleCost hole_cost(const HoleCase& hole, const std::vector<std::array<Index, 3>>& triangles);

/// What is wrong with a triangulation (each edge of the loop once and along it, each other edge twice and both
/// ways, n − 2 triangles), or nothing.
std::string hole_faults(Index loop_size, const std::vector<std::array<Index, 3>>& triangles);

}  // namespace meshgraft::test
