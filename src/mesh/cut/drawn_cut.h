#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/mesh/cut.h>

#include "mesh/traced_faces.h"

namespace meshgraft {

using Side = std::int8_t;  // 1 above, -1 below, 0 neither

/// A surface with a cut drawn along its edges, before it is separated. Its vertices are those of the mesh,
/// some of them moved along an edge, followed by inserted ones.
struct DrawnCut {
  TracedFaces faces;
  std::vector<EdgePoint> origin;  ///< per vertex
  Points positions;               ///< per vertex
  Points normals;                 ///< per vertex: unit normals of the whole surface, or zero where undefined
  /// Per corner: side of its half-edge if that lies on the cut, otherwise 0
  std::vector<Side> side;
  std::vector<Side> face_side;    ///< per face; faces with 0 are always kept
  std::vector<Side> vertex_side;  ///< per vertex of the mesh, for isolated ones; those with 0 are always kept
};

/// Throws Error(input) for a mesh without faces or of huge coordinates, and for options out of range.
void check(const Mesh& mesh, const CutOptions& options);

/// Throws Error(input) if the options ask for caps.
void require_open(const CutOptions& options);

/// Returns the normals of the whole surface at all vertices, including those inserted by the cut.
Points whole_normals(const Mesh& mesh, const DrawnCut& cut);

/// Separates the surface along the cut. A vertex on the cut is duplicated, with one copy per fan of faces
/// around it. Tells in `closed`, unless it is null, whether all edges along the cut are in closed loops. Others
/// are in chains that end at an edge of three or more faces.
CutResult separate(const Mesh& mesh, const DrawnCut& cut, CutKeep keep, const Context& context,
                   bool* closed = nullptr);

}  // namespace meshgraft
