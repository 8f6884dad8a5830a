#pragma once

#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/cut.h>

#include "cap_region.h"

namespace meshgraft {

/// A triangle of the half that takes the holes: x and y in the plane of the cut, z the depth behind it.
using DeepTriangle = std::array<Eigen::Vector3d, 3>;

/// Pins of equal size on one cap.
struct PinFit {
  std::vector<Point2> centres;
  double diameter = 0, length = 0, clearance = 0;
  bool shortened = false;  ///< the length is less than was asked for
  Index left_out = 0;      ///< pins that were asked for and have no room

  double hole_radius() const { return diameter / 2 + clearance; }
};

/// Returns places for `count` equal circles within a region, as large as possible, and their radius. They are
/// found on a grid of some thousand points: each next one where it is the largest, then one after another is
/// moved to where it can grow. Returns none where the grid has no point inside.
struct CirclePacking {
  std::vector<Point2> centres;
  double radius = 0;
};
CirclePacking pack_circles(std::span<const Point2> points, const CapRegion& region, Index count,
                           const Context& context = {});

/// Returns how deep a round hole of this radius can be until it meets a triangle; infinite if it meets none.
double free_depth(std::span<const DeepTriangle> half, const Point2& centre, double radius);

/// Fits pins of the cut's options to a cap. A hole keeps a quarter of the pin's diameter from the surface on
/// all sides. Sizes that are not given shrink to a fifth if needed. Then pins become shorter, down to half
/// their diameter, then fewer. Returns a fit without centres if none fits.
PinFit fit_pins(std::span<const Point2> points, const CapRegion& region, std::span<const DeepTriangle> half,
                const CutOptions& options, const Context& context = {});

}  // namespace meshgraft
