#include "pin_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

namespace meshgraft {

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();
constexpr Index usual_count = 2;
constexpr double usual_diameter_rel = 0.8;    // × the radius of the packed circles
constexpr double usual_length_rel = 1.5;      // × the diameter
constexpr double usual_clearance_rel = 0.05;  // × the diameter
constexpr double wall_rel = 0.25;             // × the diameter
constexpr double least_length_rel = 0.5;      // × the diameter
constexpr std::array shrinking{1.0, 0.8, 0.6, 0.45, 0.3, 0.2};

double distance(const Point2& a, const Point2& b) { return std::hypot(a[0] - b[0], a[1] - b[1]); }

// A place for a circle, and its distance to the outlines.
struct Candidate {
  Point2 at;
  double room = 0;
};

std::vector<Candidate> candidates_in(std::span<const Point2> points, const CapRegion& region,
                                     const Context& context) {
  constexpr double wanted = 6000;
  Point2 low = points[region.outer.front()], high = low;
  for (const Index k : region.outer)
    for (std::size_t axis = 0; axis < 2; ++axis) {
      low[axis] = std::min(low[axis], points[k][axis]);
      high[axis] = std::max(high[axis], points[k][axis]);
    }
  const double width = high[0] - low[0], height = high[1] - low[1];
  // Regions that fill little of their box get a coarser grid than their area alone would.
  const double step =
      std::max(std::sqrt(area(points, region) / wanted), std::sqrt(width * height / (8 * wanted)));
  const auto columns = static_cast<int>(std::ceil(width / step)),
             rows = static_cast<int>(std::ceil(height / step));
  std::vector<Candidate> all;
  for (int row = 0; row < rows; ++row) {
    context.throw_if_stopped();
    for (int column = 0; column < columns; ++column) {
      const Point2 at{low[0] + (column + 0.5) * width / columns, low[1] + (row + 0.5) * height / rows};
      if (const double room = distance_within(points, region, at); room > 0) all.push_back({at, room});
    }
  }
  return all;
}

// Returns the radius of a circle at a candidate beside the others, `skip` left out.
double radius_at(const Candidate& candidate, const std::vector<Candidate>& others, std::size_t skip) {
  double radius = candidate.room;
  for (std::size_t k = 0; k < others.size(); ++k)
    if (k != skip) radius = std::min(radius, distance(candidate.at, others[k].at) / 2);
  return radius;
}

Candidate best_beside(const std::vector<Candidate>& all, const std::vector<Candidate>& others,
                      std::size_t skip) {
  const Candidate* best = &all.front();
  double largest = -1;
  for (const Candidate& candidate : all) {
    if (candidate.room <= largest) continue;
    const double radius = radius_at(candidate, others, skip);
    if (radius <= largest) continue;
    largest = radius;
    best = &candidate;
  }
  return *best;
}

// Returns the least height of a triangle over a disc, at least 0; infinite where it is not over it.
double lowest_over_disc(const DeepTriangle& triangle, const Point2& centre, double radius) {
  double low = unbounded;
  const auto offer = [&](double height) { low = std::min(low, std::max(0.0, height)); };
  std::array<Eigen::Vector3d, 3> p = triangle;
  for (Eigen::Vector3d& corner : p) corner -= Eigen::Vector3d(centre[0], centre[1], 0);
  for (const Eigen::Vector3d& corner : p)
    if (corner.head<2>().norm() < radius) offer(corner.z());
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector3d &a = p[k], d = p[(k + 1) % 3] - a;
    const double dd = d.head<2>().squaredNorm(), ad = a.head<2>().dot(d.head<2>());
    const double root = ad * ad - dd * (a.head<2>().squaredNorm() - radius * radius);
    if (!(dd > 0) || root <= 0) continue;
    for (const double sign : {-1.0, 1.0})
      if (const double t = (-ad + sign * std::sqrt(root)) / dd; t >= 0 && t <= 1) offer(a.z() + t * d.z());
  }
  const Eigen::Vector3d normal = (p[1] - p[0]).cross(p[2] - p[0]);
  if (normal.z() == 0) return low;
  const Eigen::Vector2d slope = -normal.head<2>() / normal.z();
  const Eigen::Vector2d foot =
      slope.norm() > 0 ? Eigen::Vector2d(-radius * slope.normalized()) : Eigen::Vector2d(0, 0);
  bool left = true, right = true;
  for (std::size_t k = 0; k < 3; ++k) {
    const Eigen::Vector2d a = p[k].head<2>(), b = p[(k + 1) % 3].head<2>();
    const double turn = (b - a).x() * (foot - a).y() - (b - a).y() * (foot - a).x();
    left = left && turn >= 0;
    right = right && turn <= 0;
  }
  if (left || right) offer(p[0].z() + slope.dot(foot - p[0].head<2>()));
  return low;
}

// The least depth that is free behind all pins of a cap, less the wall.
double room_behind(std::span<const DeepTriangle> half, const std::vector<Point2>& centres, double radius,
                   double wall) {
  double room = unbounded;
  for (const Point2& centre : centres) room = std::min(room, free_depth(half, centre, radius + wall) - wall);
  return room;
}

// Fits pins at the places of a packing, or returns none.
std::optional<PinFit> fit_at(const CirclePacking& packing, std::span<const DeepTriangle> half,
                             const CutOptions& options) {
  std::optional<PinFit> best;
  const double usual = usual_diameter_rel * packing.radius;
  for (const double factor : shrinking) {
    PinFit fit{.centres = packing.centres, .diameter = options.pin_diameter.value_or(factor * usual)};
    fit.clearance = options.pin_clearance.value_or(usual_clearance_rel * fit.diameter);
    const double wanted = options.pin_length.value_or(usual_length_rel * fit.diameter);
    const double wall = wall_rel * fit.diameter;
    if (fit.hole_radius() + wall > packing.radius) continue;
    const double room = room_behind(half, fit.centres, fit.hole_radius(), wall) - fit.clearance;
    fit.length = std::min(wanted, room);
    fit.shortened = fit.length < wanted;
    if (!fit.shortened) return fit;
    if (fit.length >= least_length_rel * fit.diameter && (!best || fit.length > best->length)) best = fit;
    if (options.pin_diameter) break;
  }
  return best;
}

CirclePacking pack(const std::vector<Candidate>& all, Index count, const Context& context) {
  std::vector<Candidate> placed;
  const auto none = static_cast<std::size_t>(-1);
  while (static_cast<Index>(placed.size()) < count) placed.push_back(best_beside(all, placed, none));
  constexpr int most_rounds = 20;
  for (int round = 0; round < most_rounds; ++round) {
    context.throw_if_stopped();
    bool moved = false;
    for (std::size_t k = 0; k < placed.size(); ++k) {
      const Candidate better = best_beside(all, placed, k);
      if (radius_at(better, placed, k) <= radius_at(placed[k], placed, k) * (1 + 1e-9)) continue;
      placed[k] = better;
      moved = true;
    }
    if (!moved) break;
  }
  CirclePacking packing{.radius = unbounded};
  for (std::size_t k = 0; k < placed.size(); ++k) {
    packing.centres.push_back(placed[k].at);
    packing.radius = std::min(packing.radius, radius_at(placed[k], placed, k));
  }
  return packing;
}

// Returns `wanted`, or the largest number of pins for which the region has the area.
Index most_pins(double area, Index wanted, const CutOptions& options) {
  if (!options.pin_diameter) return wanted;
  const double clearance = options.pin_clearance.value_or(usual_clearance_rel * *options.pin_diameter);
  const double radius = (0.5 + wall_rel) * *options.pin_diameter + clearance;
  return std::min(wanted, static_cast<Index>(std::min(area / (std::numbers::pi * radius * radius), 1e6)));
}

}  // namespace

CirclePacking pack_circles(std::span<const Point2> points, const CapRegion& region, Index count,
                           const Context& context) {
  const std::vector<Candidate> all = candidates_in(points, region, context);
  return all.empty() ? CirclePacking{} : pack(all, count, context);
}

double free_depth(std::span<const DeepTriangle> half, const Point2& centre, double radius) {
  double depth = unbounded;
  for (const DeepTriangle& triangle : half) {
    const auto [a, b, c] = triangle;
    if (std::min({a.z(), b.z(), c.z()}) >= depth) continue;
    if (std::min({a.x(), b.x(), c.x()}) > centre[0] + radius ||
        std::max({a.x(), b.x(), c.x()}) < centre[0] - radius ||
        std::min({a.y(), b.y(), c.y()}) > centre[1] + radius ||
        std::max({a.y(), b.y(), c.y()}) < centre[1] - radius)
      continue;
    depth = std::min(depth, lowest_over_disc(triangle, centre, radius));
  }
  return depth;
}

PinFit fit_pins(std::span<const Point2> points, const CapRegion& region, std::span<const DeepTriangle> half,
                const CutOptions& options, const Context& context) {
  const Index wanted = options.pin_count.value_or(usual_count);
  const std::vector<Candidate> all = candidates_in(points, region, context);
  const Index most = all.empty() ? 0 : most_pins(area(points, region), wanted, options);
  for (Index count = most; count > 0; --count) {
    const CirclePacking packing = pack(all, count, context);
    if (std::optional<PinFit> fit = fit_at(packing, half, options)) {
      fit->left_out = options.pin_count ? wanted - count : 0;
      return *fit;
    }
  }
  return {.left_out = options.pin_count ? wanted : 0};
}

}  // namespace meshgraft
