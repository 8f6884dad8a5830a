#include "sculpture.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <utility>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft::samples {

namespace {

// Chosen: distances are taken to change no faster than this per unit of length. In a rib's groove they do, up
// to 1.5; no sample loses a part of its surface by it.
constexpr double lipschitz = 1.2;

// Returns the smaller of a and b, rounded if they differ by less than k: lower by at most k/6, twice
// differentiable.
template <int n>
Values<n> smooth_min(const Values<n>& a, const Values<n>& b, double k) {
  if (k <= 0.0) return a.min(b);
  const Values<n> h = (k - (a - b).abs()).max(0.0);
  return a.min(b) - h * h * h / (6.0 * k * k);
}

// Joins the distances of a group to those of the strokes before it.
template <int n>
Values<n> join(const Values<n>& before, const Values<n>& group, const Brush& brush) {
  if (brush.carve) return -smooth_min<n>(-before, group, brush.blend);
  return smooth_min<n>(before, group, brush.blend);
}

template <int n>
Values<n> dot(const PointBatch<n>& a, const Vec3& b) {
  return a.x * b.x() + a.y * b.y() + a.z * b.z();
}

template <int n>
Values<n> norm(const PointBatch<n>& a) {
  return (a.x.square() + a.y.square() + a.z.square()).sqrt();
}

template <int n>
PointBatch<n> minus(const PointBatch<n>& a, const Vec3& b) {
  return {a.x - b.x(), a.y - b.y(), a.z - b.z()};
}

// Returns a − t b.
template <int n>
PointBatch<n> minus(const PointBatch<n>& a, const Values<n>& t, const Vec3& b) {
  return {a.x - t * b.x(), a.y - t * b.y(), a.z - t * b.z()};
}

template <int n>
PointBatch<n> quotient(const PointBatch<n>& a, const Vec3& b) {
  return {a.x / b.x(), a.y / b.y(), a.z / b.z()};
}

PointBatch<1> batch_of(const Vec3& point) {
  PointBatch<1> batch;
  batch.set(0, point);
  return batch;
}

Vec3 any_normal_to(const Vec3& axis) {
  const Vec3 other = std::abs(axis.x()) < 0.7 ? Vec3::UnitX() : Vec3::UnitY();
  return axis.cross(other).normalized();
}

}  // namespace

void Sculpture::ellipsoid(const Vec3& centre, const Vec3& radii, const Brush& brush,
                          const Eigen::Matrix3d& axes) {
  Stroke stroke{Shape::ellipsoid, brush, groups_++};
  stroke.a = centre;
  stroke.radii = radii;
  stroke.axes = axes;
  strokes_.push_back(std::move(stroke));
}

void Sculpture::chain(std::span<const Knot> knots, const Brush& brush, const Ribs& ribs) {
  const int group = groups_++;
  Vec3 normal = Vec3::Zero();
  for (std::size_t k = 0; k + 1 < knots.size(); ++k) {
    Stroke stroke{Shape::cone, brush, group};
    stroke.a = knots[k].point;
    stroke.b = knots[k + 1].point - knots[k].point;
    stroke.radii = Vec3(knots[k].radius, knots[k + 1].radius, 0);
    stroke.inverse_length2 = 1.0 / stroke.b.squaredNorm();
    stroke.ribs = ribs;
    const Vec3 tangent = stroke.b.normalized();
    // Transporting the normal along the chain keeps the ribs from twisting.
    normal = k == 0 ? any_normal_to(tangent) : (normal - tangent * tangent.dot(normal)).normalized();
    stroke.axes << normal, tangent.cross(normal), tangent;
    strokes_.push_back(std::move(stroke));
  }
}

void Sculpture::ring(const Vec3& centre, const Vec3& axis, double radius, double thickness,
                     const Brush& brush) {
  Stroke stroke{Shape::ring, brush, groups_++};
  stroke.a = centre;
  stroke.b = axis.normalized();
  stroke.radii = Vec3(radius, thickness, 0);
  strokes_.push_back(std::move(stroke));
}

void Sculpture::half_space(const Vec3& point, const Vec3& normal, const Brush& brush) {
  Stroke stroke{Shape::half_space, brush, groups_++};
  stroke.a = point;
  stroke.b = normal.normalized();
  strokes_.push_back(std::move(stroke));
}

void Sculpture::set_relief(std::function<double(const Vec3&)> relief, double amplitude) {
  relief_ = std::move(relief);
  relief_amplitude_ = amplitude;
}

void Sculpture::bounds(Vec3& low, Vec3& high) const {
  low.setConstant(std::numeric_limits<double>::infinity());
  high = -low;
  for (const Stroke& stroke : strokes_) {
    if (stroke.brush.carve || stroke.shape == Shape::half_space) continue;
    double radius = stroke.radii.maxCoeff() + stroke.brush.blend + relief_amplitude_;
    if (stroke.shape == Shape::ring) radius += stroke.radii[1];
    low = low.cwiseMin((stroke.a.array() - radius).matrix());
    high = high.cwiseMax((stroke.a.array() + radius).matrix());
    if (stroke.shape != Shape::cone) continue;
    low = low.cwiseMin((stroke.a + stroke.b).array().matrix() - Vec3::Constant(radius));
    high = high.cwiseMax((stroke.a + stroke.b).array().matrix() + Vec3::Constant(radius));
  }
}

double Sculpture::rib_depth(const Stroke& stroke, const Vec3& radial, double length) {
  // cos(n·angle) is the real part of (u + iv)ⁿ / |u + iv|ⁿ; plain products are faster than the functions.
  const double u = radial.dot(stroke.axes.col(0)), v = radial.dot(stroke.axes.col(1));
  const double across2 = u * u + v * v;
  if (across2 < 1e-20) return 0.0;
  const double inverse = 1.0 / std::sqrt(across2);
  const double c = u * inverse, s = v * inverse;
  double real = 1.0, imaginary = 0.0;
  for (int i = 0; i < stroke.ribs.count; ++i) {
    const double next = real * c - imaginary * s;
    imaginary = real * s + imaginary * c;
    real = next;
  }
  return across2 / (length * length) * (0.5 - 0.5 * real);  // fades out towards a round end
}

template <int n>
Values<n> Sculpture::stroke_distances(const Stroke& stroke, const PointBatch<n>& points) {
  switch (stroke.shape) {
    case Shape::ellipsoid: {
      // First-order distance: (level − 1)·level / |gradient|, exact on the surface and for a sphere.
      const PointBatch<n> from_centre = minus(points, stroke.a);
      const PointBatch<n> local{dot(from_centre, stroke.axes.col(0)), dot(from_centre, stroke.axes.col(1)),
                                dot(from_centre, stroke.axes.col(2))};
      const PointBatch<n> scaled = quotient(local, stroke.radii);
      const Values<n> level = norm(scaled), slope = norm(quotient(scaled, stroke.radii));
      return (slope > 1e-12).select(level * (level - 1.0) / slope, -stroke.radii.minCoeff());
    }
    case Shape::cone: {
      const PointBatch<n> from_a = minus(points, stroke.a);
      const Values<n> t = (dot(from_a, stroke.b) * stroke.inverse_length2).max(0.0).min(1.0);
      const PointBatch<n> radial = minus(from_a, t, stroke.b);
      const Values<n> length = norm(radial);
      Values<n> radius = stroke.radii[0] + t * (stroke.radii[1] - stroke.radii[0]);
      if (stroke.ribs.count > 0)
        for (int i = 0; i < n; ++i)
          radius[i] *= 1.0 - stroke.ribs.depth_rel *
                                 rib_depth(stroke, Vec3(radial.x[i], radial.y[i], radial.z[i]), length[i]);
      return length - radius;
    }
    case Shape::ring: {
      const PointBatch<n> local = minus(points, stroke.a);
      const Values<n> along = dot(local, stroke.b);
      const Values<n> across = norm(minus(local, along, stroke.b)) - stroke.radii[0];
      return (along.square() + across.square()).sqrt() - stroke.radii[1];
    }
    case Shape::half_space: return dot(minus(points, stroke.a), stroke.b);
  }
  return Values<n>::Zero();
}

template <int n>
Values<n> Sculpture::group_distances(const PointBatch<n>& points, std::span<const int> active,
                                     std::size_t& begin) const {
  const int group = strokes_[active[begin]].group;
  Values<n> nearest = stroke_distances(strokes_[active[begin]], points);
  for (++begin; begin < active.size() && strokes_[active[begin]].group == group; ++begin)
    nearest = nearest.min(stroke_distances(strokes_[active[begin]], points));
  return nearest;
}

template <int n>
Values<n> Sculpture::distances(const PointBatch<n>& points, std::span<const int> active) const {
  Values<n> d = Values<n>::Constant(1e9);
  for (std::size_t i = 0; i < active.size();) {
    const Brush& brush = strokes_[active[i]].brush;
    d = join<n>(d, group_distances(points, active, i), brush);
  }
  if (relief_)
    for (int i = 0; i < n; ++i) d[i] -= relief_(Vec3(points.x[i], points.y[i], points.z[i]));
  return d;
}

template Values<8> Sculpture::distances(const PointBatch<8>&, std::span<const int>) const;

Vec3 Sculpture::colour(const Vec3& x, std::span<const int> active) const {
  const PointBatch<1> point = batch_of(x);
  Values<1> d = Values<1>::Constant(1e9);
  Vec3 mixed = Brush{}.colour;
  for (std::size_t i = 0; i < active.size();) {
    const Brush& brush = strokes_[active[i]].brush;
    const Values<1> e = group_distances(point, active, i);
    const double ahead = (brush.carve ? d[0] + e[0] : d[0] - e[0]) / std::max(0.6 * brush.blend, 1e-9);
    const double share =
        brush.carve ? std::clamp(0.5 - 0.5 * ahead, 0.0, 1.0) : std::clamp(0.5 + 0.5 * ahead, 0.0, 1.0);
    mixed += share * (brush.colour - mixed);
    d = join<1>(d, e, brush);
  }
  return mixed;
}

std::vector<int> Sculpture::prune(const Vec3& centre, double radius, std::span<const int> active) const {
  const double reach = lipschitz * radius;
  const PointBatch<1> point = batch_of(centre);
  std::vector<int> kept;
  std::vector<double> distances;
  double upper = 1e9;  // upper bound on the distance over the ball
  for (std::size_t begin = 0; begin < active.size();) {
    const Stroke& first = strokes_[active[begin]];
    std::size_t end = begin;
    double nearest = std::numeric_limits<double>::infinity();
    distances.clear();
    for (; end < active.size() && strokes_[active[end]].group == first.group; ++end) {
      distances.push_back(stroke_distances(strokes_[active[end]], point)[0]);
      nearest = std::min(nearest, distances.back());
    }
    // An added stroke matters if it comes within its blend radius of the rest; a carving stroke, near the
    // surface.
    const double limit = first.brush.carve ? reach + first.brush.blend : upper + first.brush.blend;
    for (std::size_t i = begin; i < end; ++i)
      if (distances[i - begin] - reach <= std::min(limit, nearest + reach)) kept.push_back(active[i]);
    upper = first.brush.carve ? std::max(upper, reach - nearest) + first.brush.blend
                              : std::min(upper, nearest + reach);
    begin = end;
  }
  return kept;
}

SparseField::SparseField(const Sculpture& sculpture, double cell, const Context& context)
    : sculpture_(sculpture), cell_(cell), everything_(sculpture.stroke_count()) {
  for (std::size_t i = 0; i < everything_.size(); ++i) everything_[i] = static_cast<int>(i);
  Vec3 low, high;
  sculpture.bounds(low, high);
  const double block_side = block_cells * cell;
  while (blocks_per_side_ * block_side < (high - low).maxCoeff() + 4.0 * cell) blocks_per_side_ *= 2;
  origin_ = 0.5 * (low + high) - Vec3::Constant(0.5 * blocks_per_side_ * block_side);

  // Builds one level at a time. Drops cells that cannot meet the surface, and keeps in the others only the
  // strokes that matter there. The ball reaches half a lattice cell beyond the block, as the block's
  // tetrahedra do.
  std::vector<Block> level{{Eigen::Vector3i::Zero(), everything_}};
  for (int side = blocks_per_side_; side > 1; side /= 2) {
    const int half = side / 2;
    const double radius = std::sqrt(3.0) * (0.5 * half * block_side + 0.5 * cell);
    const std::size_t first_child = children_.size() + level.size();
    std::vector<std::array<std::optional<Block>, 8>> found(level.size());
    parallel_blocks(
        level.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t n = begin; n < end; ++n) {
            PointBatch<8> centres;
            const auto position = [&](int child) -> Eigen::Vector3i {
              return level[n].position + half * Eigen::Vector3i(child & 1, (child >> 1) & 1, child >> 2);
            };
            const auto centre = [&](int child) -> Vec3 {
              return origin_ + block_side * (position(child).cast<double>() + Vec3::Constant(0.5 * half));
            };
            for (int child = 0; child < 8; ++child) centres.set(child, centre(child));
            const Values<8> d = sculpture.distances(centres, level[n].active);
            for (int child = 0; child < 8; ++child)
              if (!is_clear(d[child], radius))
                found[n][child] =
                    Block{position(child), sculpture.prune(centre(child), radius, level[n].active)};
          }
        },
        context, 16);
    level.clear();
    const std::size_t base = half > 1 ? first_child : 0;
    for (auto& blocks : found) {
      std::array<int, 8>& children = children_.emplace_back();
      for (std::size_t c = 0; c < 8; ++c) {
        children[c] = blocks[c] ? static_cast<int>(base + level.size()) : -1;
        if (blocks[c]) level.push_back(std::move(*blocks[c]));
      }
    }
  }
  blocks_ = std::move(level);
}

bool SparseField::is_clear(double d, double radius) const {
  return std::abs(d) > lipschitz * radius + 2.0 * sculpture_.relief_amplitude();
}

std::span<const int> SparseField::active_at(const Vec3& x) const {
  const Vec3 local = (x - origin_) / (block_cells * cell_);
  const Eigen::Vector3i position = local.array().floor().cast<int>();
  if (position.minCoeff() < 0 || position.maxCoeff() >= blocks_per_side_ || children_.empty())
    return everything_;
  int node = 0;
  for (int half = blocks_per_side_ / 2; half > 0 && node >= 0; half /= 2) {
    const int child =
        (position.x() & half ? 1 : 0) | (position.y() & half ? 2 : 0) | (position.z() & half ? 4 : 0);
    node = children_[node][child];
  }
  return node < 0 ? everything_ : blocks_[node].active;
}

double SparseField::distance_and_gradient(const Vec3& x, Vec3& gradient) const {
  const auto active = active_at(x);
  const double e = 0.02 * cell_;
  const std::array corners{Vec3(1, 1, 1), Vec3(1, -1, -1), Vec3(-1, 1, -1), Vec3(-1, -1, 1)};
  PointBatch<4> points;
  for (int i = 0; i < 4; ++i) points.set(i, x + e * corners[i]);
  const Values<4> d = sculpture_.distances(points, active);
  double sum = 0.0;
  gradient.setZero();
  for (int i = 0; i < 4; ++i) {
    sum += d[i];
    gradient += d[i] * corners[i];
  }
  gradient /= 4.0 * e;
  return 0.25 * sum;
}

double hash_unit(unsigned a, unsigned b, unsigned c, unsigned seed) {
  std::uint64_t h = seed;
  for (const unsigned value : {a, b, c}) {
    h = (h ^ value) * 0x9E3779B97F4A7C15ull;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9ull;
    h ^= h >> 27;
  }
  return static_cast<double>(h >> 11) * 0x1.0p-53;
}

double noise(const Vec3& x, unsigned seed) {
  const Vec3 cell = x.array().floor();
  Vec3 t = x - cell;
  t = (t.array() * t.array() * t.array() * (t.array() * (t.array() * 6.0 - 15.0) + 10.0)).matrix();
  double sum = 0.0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1.0;
    unsigned key[3];
    for (int k = 0; k < 3; ++k) {
      const int bit = (corner >> k) & 1;
      key[k] = static_cast<unsigned>(static_cast<int>(cell[k]) + bit);
      weight *= bit ? t[k] : 1.0 - t[k];
    }
    sum += weight * hash_unit(key[0], key[1], key[2], seed);
  }
  return 2.0 * sum - 1.0;
}

}  // namespace meshgraft::samples
