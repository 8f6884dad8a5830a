#include "flat_loop.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "loop_curve.h"
#include "loops.h"
#include "merge/facts.h"
#include "mesh/area_vector.h"

namespace meshgraft {

namespace {

using Vector = Eigen::RowVector3d;

/// Moves a polygon's centre of area to the origin and returns its previous position.
Eigen::RowVector2d centre(PlanePoints& polygon) {
  Eigen::RowVector2d sum = Eigen::RowVector2d::Zero();
  const Eigen::RowVector2d mean = polygon.colwise().mean();
  polygon.rowwise() -= mean;
  for (Eigen::Index i = 0; i < polygon.rows(); ++i) {
    const Eigen::RowVector2d a = polygon.row(i), b = polygon.row((i + 1) % polygon.rows());
    sum += cross(a, b) * (a + b) / 3;
  }
  const Eigen::RowVector2d shift = sum / double_area(polygon);
  polygon.rowwise() -= shift;
  return mean + shift;
}

/// Smooths a polygon until it does not cross itself, then restores its width.
bool smooth_until_simple(PlanePoints& polygon) {
  constexpr int most_passes = 400, passes_at_once = 8;
  const double width = Outline(polygon).width();
  const Eigen::Index count = polygon.rows();
  for (int pass = 0; pass < most_passes; ++pass) {
    if (pass % passes_at_once == 0 && is_simple(polygon)) {
      polygon *= width / Outline(polygon).width();
      return true;
    }
    PlanePoints next = polygon;
    for (Eigen::Index i = 0; i < count; ++i)
      next.row(i) =
          (polygon.row((i + count - 1) % count) + 2 * polygon.row(i) + polygon.row((i + 1) % count)) / 4;
    polygon = std::move(next);
  }
  return false;
}

FlatLoop flatten(const Mesh& source, std::vector<Index> loop) {
  constexpr double least_area = 0.02;  // × the area of a circle of the loop's length
  Points points(static_cast<Eigen::Index>(loop.size()), 3);
  for (std::size_t i = 0; i < loop.size(); ++i)
    points.row(static_cast<Eigen::Index>(i)) = source.positions.row(loop[i]);
  const Vector axis = loop_axis(points), first = axis.transpose().unitOrthogonal().transpose();
  Eigen::Matrix<double, 3, 2> axes;
  axes << first.transpose(), axis.transpose().cross(first.transpose());
  const Vector mean = points.colwise().mean();
  PlanePoints polygon = (points.rowwise() - mean) * axes;
  const double length = LoopCurve(points).length();
  if (!(2 * std::numbers::pi * double_area(polygon) > least_area * length * length))
    throw Error(facts::merge::LoopWithoutArea{.vertex = loop.front()});
  const bool simple = is_simple(polygon);
  if (!simple && !smooth_until_simple(polygon))
    throw Error(facts::merge::LoopCrossesItself{.vertex = loop.front()});
  const Vector middle = mean + centre(polygon) * axes.transpose();
  return {std::move(loop), axis, first, middle, Outline(std::move(polygon)), !simple};
}

/// Returns the convex hull of points of the plane, counter-clockwise (Andrew 1979).
PlanePoints convex_hull(std::vector<Eigen::RowVector2d> points) {
  std::sort(points.begin(), points.end(),
            [](const auto& a, const auto& b) { return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y()); });
  std::vector<Eigen::RowVector2d> hull;
  const auto add_chain = [&](auto first, auto last) {
    const std::size_t start = hull.size();
    for (auto point = first; point != last; ++point) {
      while (hull.size() >= start + 2 && cross(hull.back() - hull[hull.size() - 2], *point - hull.back()) <= 0)
        hull.pop_back();
      hull.push_back(*point);
    }
    hull.pop_back();  // the other chain begins with it
  };
  add_chain(points.begin(), points.end());
  add_chain(points.rbegin(), points.rend());
  PlanePoints polygon(static_cast<Eigen::Index>(hull.size()), 2);
  for (std::size_t k = 0; k < hull.size(); ++k) polygon.row(static_cast<Eigen::Index>(k)) = hull[k];
  return polygon;
}

}  // namespace

FlatLoop hull_of_loops(const Points& source, const std::vector<FlatLoop>& loops) {
  const Vector axis = loops.front().axis, first = loops.front().first_axis;
  Eigen::Matrix<double, 3, 2> axes;
  axes << first.transpose(), axis.transpose().cross(first.transpose());
  const Vector origin = loops.front().centre;
  std::vector<Eigen::RowVector2d> points;
  for (const FlatLoop& loop : loops)
    for (const Index v : loop.vertices) points.emplace_back((source.row(v) - origin) * axes);
  PlanePoints polygon = convex_hull(std::move(points));
  const Vector middle = origin + centre(polygon) * axes.transpose();
  return {{}, axis, first, middle, Outline(std::move(polygon))};
}

FlatLoop moved(const FlatLoop& loop, const Eigen::Affine3d& map) {
  const double scale = std::cbrt(map.linear().determinant());
  const Eigen::Matrix3d rotation = map.linear() / scale;
  FlatLoop result = loop;
  result.axis = loop.axis * rotation.transpose();
  result.first_axis = loop.first_axis * rotation.transpose();
  result.centre = (map * loop.centre.transpose()).transpose();
  result.outline = loop.outline.scaled(scale);
  return result;
}

FlatLoop flatten_loop(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop) {
  std::vector<Index> loop = checked_loop(source, facts::merge::Side::source, source_loop);
  if (windings_disagree(target, source)) std::reverse(loop.begin(), loop.end());  // it will be turned over
  return flatten(source, std::move(loop));
}

}  // namespace meshgraft
