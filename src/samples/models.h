#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "sculpture.h"

namespace meshgraft::samples {

/// A modelled solid and how it becomes a mesh.
struct SculptedModel {
  Sculpture sculpture;
  double area = 0.0;         ///< of the surface, about; relates the resolution to the edge length
  double finest_cell = 0.0;  ///< cells of the first polygonisation, at most; finer than the thinnest part
  bool cut = false;          ///< leave a boundary loop at z = cut_height
  double cut_height = 0.0;
  bool keep_above = true;
  int parts = 1;  ///< how many of its connected parts are kept, the largest first
};

SculptedModel octopus();
SculptedModel head();
SculptedModel bust();
SculptedModel dinosaur();
SculptedModel cactus();
SculptedModel bracket();
SculptedModel posts();

Mesh bumpy_plane(int resolution);
Mesh bar(int resolution);
Mesh cylinder(int resolution);
Mesh torus(int resolution);
Mesh knot(int resolution);

}  // namespace meshgraft::samples
