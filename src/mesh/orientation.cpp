#include <meshgraft/mesh/orientation.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numeric>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "area_vector.h"
#include "mesh/facts.h"
#include "vertex_tree.h"

namespace meshgraft {

namespace {

constexpr Eigen::Index sample_count = 2500;
constexpr Eigen::Index surface_count = 20'000;  // dense enough to tell an exact mirror image from a near one

// Weights of the evidence, in nats. They were fitted, together with those in merge/start_candidates.cpp, to
// grafts of models with a known orientation (docs/merging.md, "Starts").
constexpr double usual_up = 1.9, usual_front = 1.5;
constexpr double asymmetry_weight = 32;  // per distance of mirrored samples from the surface, × the RMS radius
constexpr double base_weight = 8.4;      // per share of the footprint that the base covers
// Chosen: an exact mirror plane is made on purpose; a nearly exact one is found in round things, too.
constexpr double exact_mirror = 3, exact_within = 0.01;
constexpr double lean_weight = 8;   // chosen, per squared lean; animals hold their heads high and forward
constexpr double whole_weight = 2;  // chosen, × all evidence: closed models show more than pieces do

struct Samples {
  Points points, normals;

  // Returns the area of the surface's openings, × its own: the normals of a closed surface add up to zero.
  double opening_share() const { return normals.colwise().mean().norm(); }
};

// Returns points at equal shares of the area, so that they depend on the surface and not on its triangles.
Samples surface_samples(const Mesh& mesh, Eigen::Index count) {
  const Triangles triangles = triangulate(mesh, {.skip_out_of_range = true}).triangles;
  std::vector<double> areas(triangles.rows());
  for (Eigen::Index t = 0; t < triangles.rows(); ++t) {
    const double area = area_vector(triangles, t, mesh.positions).norm();
    areas[t] = std::isfinite(area) ? area : 0;
  }
  std::partial_sum(areas.begin(), areas.end(), areas.begin());
  if (areas.empty() || !(areas.back() > 0)) return {Points(0, 3), Points(0, 3)};
  Samples samples{Points(count, 3), Points(count, 3)};
  Eigen::Index t = 0;
  for (Eigen::Index i = 0; i < count; ++i) {
    const double share = (static_cast<double>(i) + 0.5) / static_cast<double>(count) * areas.back();
    while (areas[t] < share) ++t;
    // The plastic number's sequence spreads the samples within triangles.
    double u = std::fmod(0.5 + 0.7548776662466927 * static_cast<double>(i), 1);
    double v = std::fmod(0.5 + 0.5698402909980532 * static_cast<double>(i), 1);
    if (u + v > 1) u = 1 - u, v = 1 - v;
    const auto corner = [&](int k) { return mesh.positions.row(triangles(t, k)); };
    samples.points.row(i) = (1 - u - v) * corner(0) + u * corner(1) + v * corner(2);
    samples.normals.row(i) = area_vector(triangles, t, mesh.positions).normalized();
  }
  return samples;
}

// Returns the mean distance of mirrored samples from the surface, × the RMS radius. The mirror is at a right
// angle to a coordinate axis: the better one of the planes through the centroid and through the middle of the
// bounding box. The surface is the tangent planes of its samples, whose spacing does not count then.
double asymmetry(const Points& samples, const Samples& surface, const VertexTree& tree, double radius,
                 int axis) {
  constexpr double farthest = 0.5;  // chosen, × the radius: what has no image counts no more than this
  double least = farthest;
  const auto along = samples.col(axis);
  for (const double middle : {along.mean(), (along.minCoeff() + along.maxCoeff()) / 2}) {
    double sum = 0;
    for (Eigen::Index i = 0; i < samples.rows(); ++i) {
      Eigen::RowVector3d image = samples.row(i);
      image[axis] = 2 * middle - image[axis];
      const Index nearest = tree.nearest(image)->vertex;
      const double distance = std::abs((image - surface.points.row(nearest)).dot(surface.normals.row(nearest)));
      sum += std::min(distance / radius, farthest);
    }
    least = std::min(least, sum / static_cast<double>(samples.rows()));
  }
  return least;
}

// Returns the area of the convex hull of points in the plane (Andrew's monotone chain).
double hull_area(std::vector<Eigen::Vector2d> points) {
  if (points.size() < 3) return 0;
  std::ranges::sort(points, {}, [](const Eigen::Vector2d& p) { return std::pair(p.x(), p.y()); });
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  double area = 0;
  for (const bool upper : {false, true}) {
    std::vector<Eigen::Vector2d> chain;
    for (const Eigen::Vector2d& p : points) {
      while (chain.size() > 1 && cross(chain.back() - chain[chain.size() - 2], p - chain.back()) <= 0)
        chain.pop_back();
      chain.push_back(p);
    }
    for (std::size_t k = 1; k < chain.size(); ++k) area += cross(chain[k - 1], chain[k]) / 2;
    if (!upper) std::ranges::reverse(points);
  }
  return area;
}

// Returns the share of the footprint, a box, that the convex hull of the lowest samples covers.
double base_share(const Points& samples, const Eigen::Vector3d& up, int axis) {
  constexpr double low = 0.06;        // chosen, × the height
  constexpr double outlying = 0.002;  // chosen, share of samples below the ground
  const int across = (axis + 1) % 3, along = (axis + 2) % 3;
  const Eigen::VectorXd height = samples * up;
  std::vector<double> sorted(height.begin(), height.end());
  const auto ground =
      sorted.begin() + static_cast<std::ptrdiff_t>(outlying * static_cast<double>(sorted.size()));
  std::nth_element(sorted.begin(), ground, sorted.end());
  const double most = *ground + low * (height.maxCoeff() - *ground);
  std::vector<Eigen::Vector2d> base;
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    if (height[i] < most) base.emplace_back(samples(i, across), samples(i, along));
  const auto extent = [&](int k) { return samples.col(k).maxCoeff() - samples.col(k).minCoeff(); };
  const double footprint = extent(across) * extent(along);
  return footprint > 0 ? hull_area(std::move(base)) / footprint : 0;
}

// Returns how far the uppermost samples lie from the middle of all, × the RMS radius.
Eigen::Vector3d lean(const Points& samples, const Eigen::Vector3d& up, double radius) {
  constexpr double upper = 0.7;  // chosen, × the height
  const Eigen::VectorXd height = samples * up;
  const double least = height.minCoeff() + upper * (height.maxCoeff() - height.minCoeff());
  Eigen::RowVector3d sum = Eigen::RowVector3d::Zero();
  int count = 0;
  for (Eigen::Index i = 0; i < samples.rows(); ++i)
    if (height[i] >= least) sum += samples.row(i), ++count;
  return ((sum / count - samples.colwise().mean()) / radius).transpose();
}

Eigen::Vector3d axis_direction(int direction) {
  return direction < 3 ? Eigen::Vector3d(Eigen::Vector3d::Unit(direction))
                       : Eigen::Vector3d(-Eigen::Vector3d::Unit(direction - 3));
}

// The evidence for each of the six directions to be up and for each axis to run from side to side, and where
// the upper part leans with each of the six directions up.
struct Evidence {
  std::array<double, 6> up{};
  std::array<double, 3> side{};
  std::array<Eigen::Vector3d, 6> lean;
  double weight = 1;  // of all evidence

  Evidence() { lean.fill(Eigen::Vector3d::Zero()); }
};

Evidence evidence_of(const Mesh& mesh) {
  Evidence evidence;
  const Points samples = surface_samples(mesh, sample_count).points;
  if (samples.rows() == 0) return evidence;
  const double radius =
      std::sqrt((samples.rowwise() - samples.colwise().mean()).rowwise().squaredNorm().mean());
  if (!(radius > 0)) return evidence;
  const Samples surface = surface_samples(mesh, surface_count);
  std::vector<Index> all(surface.points.rows());
  std::iota(all.begin(), all.end(), Index{0});
  const VertexTree tree(surface.points, std::move(all));
  for (int axis = 0; axis < 3; ++axis) {
    const double difference = asymmetry(samples, surface, tree, radius, axis);
    evidence.side[axis] = exact_mirror * std::exp(-difference / exact_within) - asymmetry_weight * difference;
  }
  constexpr double most_open = 0.02;  // chosen; where a piece was cut off tells more of its lean than its shape
  const bool is_whole = surface.opening_share() < most_open;
  if (is_whole) evidence.weight = whole_weight;
  for (int k = 0; k < 6; ++k) {
    const Eigen::Vector3d up = axis_direction(k);
    evidence.up[k] = base_weight * base_share(samples, up, k % 3);
    if (is_whole) evidence.lean[k] = lean(samples, up, radius);
  }
  return evidence;
}

// Returns the logarithm of the probability that one end of an axis is the front, rather than the other, by how
// far the upper part leans to it.
double log_forward(double lean) { return -std::log1p(std::exp(-2 * lean_weight * lean * std::abs(lean))); }

bool follows_convention(int up, int front) { return (up == 1 && front == 2) || (up == 2 && front == 4); }

}  // namespace

std::optional<Eigen::Vector3d> axis_named(std::string_view name) {
  const bool negative = name.starts_with('-');
  if (negative) name.remove_prefix(1);
  if (name.size() != 1 || name[0] < 'x' || name[0] > 'z') return std::nullopt;
  return axis_direction(name[0] - 'x' + (negative ? 3 : 0));
}

Orientation make_orientation(const Eigen::Vector3d& up, const Eigen::Vector3d& front) {
  const Eigen::Vector3d above = up.stableNormalized();
  const Eigen::Vector3d facing = front.stableNormalized(), level = facing - facing.dot(above) * above;
  constexpr double parallel = 1e-6;
  if (!(above.norm() > 0.5) || !(level.norm() > parallel)) throw Error(facts::mesh::OrientationUndefined{});
  return {above, level.normalized()};
}

std::vector<OrientationGuess> guess_orientations(const Mesh& mesh) {
  const Evidence evidence = evidence_of(mesh);
  std::vector<OrientationGuess> guesses;
  for (int up = 0; up < 6; ++up)
    for (int front = 0; front < 6; ++front) {
      if (up % 3 == front % 3) continue;
      const double forward = evidence.lean[up].dot(axis_direction(front));
      const double nats = (up == 1 || up == 2 ? usual_up : 0) +
                          (follows_convention(up, front) ? usual_front : 0) + evidence.up[up] +
                          evidence.side[3 - up % 3 - front % 3] + log_forward(forward);
      guesses.push_back({{axis_direction(up), axis_direction(front)}, std::exp(evidence.weight * nats)});
    }
  double sum = 0;
  for (const OrientationGuess& guess : guesses) sum += guess.probability;
  for (OrientationGuess& guess : guesses) guess.probability /= sum;
  std::ranges::stable_sort(guesses, std::greater(), &OrientationGuess::probability);
  return guesses;
}

}  // namespace meshgraft
