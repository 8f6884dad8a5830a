#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "sculpture.h"

namespace meshgraft::samples {

/// A modelled solid, and the options for meshing it.
struct SculptedModel {
  Sculpture sculpture;
  double area = 0.0;         ///< approximate surface area; relates the resolution to the edge length
  double finest_cell = 0.0;  ///< largest cell of the first polygonisation; finer than the thinnest detail
  bool cut = false;          ///< leave a boundary loop at z = cut_height
  double cut_height = 0.0;
  bool keep_above = true;
  int parts = 1;  ///< number of connected components to keep, the largest first
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
