#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/mesh/cut.h>

#include "traced_faces.h"

namespace meshgraft {

using Side = std::int8_t;  // 1 above, -1 below, 0 neither

/// A surface with a cut drawn along its edges, before it comes apart. The vertices are the mesh's own, some of
/// them moved along an edge, then inserted ones.
struct DrawnCut {
  TracedFaces faces;
  std::vector<EdgePoint> origin;  ///< per vertex
  Points positions;               ///< per vertex
  Points normals;                 ///< per vertex: the whole surface's unit normals, zero where it has none
  std::vector<Side> side;         ///< per corner: where its half-edge borders on the cut, from which side
  std::vector<Side> face_side;    ///< per face; 0 stays whatever is kept
  std::vector<Side> vertex_side;  ///< per vertex of the mesh, for those without a face; 0 stays
};

/// Throws Error(input) for options out of range.
void check(const Mesh& mesh, const CutOptions& options);

/// The whole surface's normals at all vertices, those that the cut inserted included.
Points whole_normals(const Mesh& mesh, const DrawnCut& cut);

/// Takes the surface apart along the cut. A vertex on the cut becomes one per fan of faces around it.
CutResult separate(const Mesh& mesh, const DrawnCut& cut, CutKeep keep, const Context& context);

}  // namespace meshgraft
