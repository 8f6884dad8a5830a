#pragma once

#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

#include "plane_section.h"

namespace meshgraft {

/// A closed source without its base.
struct OpenedSource {
  Mesh mesh;
  IndexMap vertex;                        ///< vertices of the closed source → `mesh`; -1 below the plane
  std::vector<Index> nearest;             ///< per vertex of `mesh`: the nearest one of the closed source
  std::vector<std::vector<Index>> loops;  ///< the loops that the plane cut, the largest first
  BaseReport report;
};

/// A plane that may open a source.
struct BasePlane {
  Plane plane;        ///< through the centre of its section; the normal is of unit length and points up
  double height = 0;  ///< of `BaseReport`
  bool flat = false;  ///< likewise
  Index loops = 0;    ///< of the section, before a tilt
};

/// The planes that may open a closed source. Without a height, they cut the source in loops that are round, lie
/// apart and are alike in size. Low planes come first, and those where the surface rises steeply from one loop;
/// then further ones. With a height there is one plane. Keeps a reference to the source.
class BaseSearch {
 public:
  /// Throws Error(input) at `base` for a height or a tilt out of range. Throws what `open` throws for a
  /// height, and Error(input) with the id merge.no_base where there is no plane.
  BaseSearch(const Mesh& source, const DropBase& base);

  const std::vector<BasePlane>& planes() const { return planes_; }

  /// Cuts off what is below a plane. Throws Error(input) at `base` where the plane misses the source, divides
  /// it, or cuts open chains, loops within one another, or loops without area (merge.base_…).
  OpenedSource open(const BasePlane& plane, const Context& context = {}) const;

 private:
  const Mesh& source_;
  PlaneSections sections_;
  std::vector<BasePlane> planes_;
};

/// Opens a source by the first plane of the search.
OpenedSource open_base(const Mesh& source, const DropBase& base = {}, const Context& context = {});

}  // namespace meshgraft
