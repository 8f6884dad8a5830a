#pragma once

#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "mesh/predicates.h"

namespace meshgraft {

/// Coordinates in a plane: x along `u`, y along `v`, height along the unit normal.
struct PlaneFrame {
  Eigen::Vector3d origin, u, v, normal;

  explicit PlaneFrame(const Plane& plane);
  Point2 coordinates(const Eigen::Vector3d& point) const {
    return {(point - origin).dot(u), (point - origin).dot(v)};
  }
  Eigen::Vector3d point(const Point2& at, double height = 0) const {
    return origin + at[0] * u + at[1] * v + height * normal;
  }
};

/// A closed polyline in a plane, by the indices of its points.
using Outline = std::vector<Index>;

/// A part of a plane inside `outer`, which runs counter-clockwise, and outside `inner`, which run clockwise.
struct CapRegion {
  Outline outer;
  std::vector<Outline> inner;
};

/// Returns the signed area of an outline, positive if it runs counter-clockwise.
double signed_area(std::span<const Point2> points, const Outline& outline);

/// Returns the area of a region.
double area(std::span<const Point2> points, const CapRegion& region);

/// Assigns each clockwise outline to the smallest counter-clockwise one around it. The regions are in the
/// order of their lowest points. Returns none if a clockwise outline has none around it.
std::vector<CapRegion> nest_outlines(std::span<const Point2> points, const std::vector<Outline>& outlines);

/// Returns a point at which the outlines of a region cross or touch, exactly, or none.
std::optional<Point2> find_crossing(std::span<const Point2> points, const CapRegion& region,
                                    const Context& context = {});

/// Returns the distance of a point to the outlines of a region, negative outside.
double distance_within(std::span<const Point2> points, const CapRegion& region, const Point2& at);

}  // namespace meshgraft
