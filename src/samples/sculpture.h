#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>

namespace meshgraft::samples {

using Vec3 = Eigen::Vector3d;

/// A number for each of n points.
template <int n>
using Values = Eigen::Array<double, n, 1>;

/// Points whose distances are computed together, several at once in the processor's vector registers.
template <int n>
struct PointBatch {
  Values<n> x, y, z;

  void set(int index, const Vec3& point) { x[index] = point.x(), y[index] = point.y(), z[index] = point.z(); }
};

/// The way a stroke joins the strokes before it.
struct Brush {
  Vec3 colour{0.80, 0.76, 0.70};  ///< sRGB, 0 … 1
  double blend = 0.05;            ///< radius of the fillet between the stroke and the rest, model units
  bool carve = false;             ///< subtract the stroke's volume instead of adding it
};

/// A point of a chain: the axis passes through `point`, at a distance of `radius` from the surface.
struct Knot {
  Vec3 point;
  double radius;
};

/// Lengthwise ribs of a chain.
struct Ribs {
  int count = 0;
  double depth_rel = 0.0;  ///< depth of the grooves, × the chain's radius
};

/// A solid modelled as an ordered list of strokes (ellipsoids, chains of cones, rings, half-spaces). Each
/// stroke is blended into the earlier ones or carved out of them. An approximate signed distance, negative
/// inside, describes the solid.
class Sculpture {
 public:
  void ellipsoid(const Vec3& centre, const Vec3& radii, const Brush& brush,
                 const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());
  void chain(std::span<const Knot> knots, const Brush& brush, const Ribs& ribs = {});
  /// Adds a torus; `axis` need not be of unit length.
  void ring(const Vec3& centre, const Vec3& axis, double radius, double thickness, const Brush& brush);
  /// Adds the half-space normal·(x − point) < 0.
  void half_space(const Vec3& point, const Vec3& normal, const Brush& brush);
  /// Adds a height field to the finished surface: |relief| ≤ amplitude.
  void set_relief(std::function<double(const Vec3&)> relief, double amplitude);

  std::size_t stroke_count() const { return strokes_.size(); }
  /// Returns a box that contains the added strokes.
  void bounds(Vec3& low, Vec3& high) const;

  /// Returns the signed distances, using only the strokes in `active` (ascending). n is 1, 4 or 8.
  template <int n>
  Values<n> distances(const PointBatch<n>& points, std::span<const int> active) const;
  /// Returns the colours of the strokes, mixed where they blend.
  Vec3 colour(const Vec3& x, std::span<const int> active) const;

  /// Returns the strokes of `active` that can change the surface within `radius` of `centre`.
  std::vector<int> prune(const Vec3& centre, double radius, std::span<const int> active) const;
  double relief_amplitude() const { return relief_amplitude_; }

 private:
  enum class Shape { ellipsoid, cone, ring, half_space };
  struct Stroke {
    Shape shape;
    Brush brush;
    int group;              // strokes of one group are united sharply before they are blended
    Vec3 a = Vec3::Zero();  // centre, or a cone's first end
    Vec3 b = Vec3::Zero();  // unit axis or normal, or a cone's other end minus its first
    Vec3 radii = Vec3::Ones();
    Eigen::Matrix3d axes = Eigen::Matrix3d::Identity();  // columns; for ribs: two normals and the tangent
    Ribs ribs = {};
    double inverse_length2 = 0.0;
  };

  /// Returns 0 on a rib's crest … 1 at the bottom of a groove.
  static double rib_depth(const Stroke& stroke, const Vec3& radial, double length);
  template <int n>
  static Values<n> stroke_distances(const Stroke& stroke, const PointBatch<n>& points);
  /// Returns the distances from the strokes of the group that begins at active[begin], and moves `begin` behind
  /// the group.
  template <int n>
  Values<n> group_distances(const PointBatch<n>& points, std::span<const int> active, std::size_t& begin) const;

  std::vector<Stroke> strokes_;
  std::function<double(const Vec3&)> relief_;
  double relief_amplitude_ = 0.0;
  int groups_ = 0;
};

/// A sculpture prepared for fast evaluation near its surface. The leaves of its octree are blocks of 2×2×2
/// lattice cells. They exist only near the surface and list the few strokes that matter there.
class SparseField {
 public:
  static constexpr int block_cells = 2;
  struct Block {
    Eigen::Vector3i position;  // in blocks
    std::vector<int> active;
  };

  SparseField(const Sculpture& sculpture, double cell, const Context& context);

  const std::vector<Block>& blocks() const { return blocks_; }
  double cell() const { return cell_; }
  int cells_per_side() const { return blocks_per_side_ * block_cells; }
  /// Returns a point of the lattice; coordinates are in half cells.
  Vec3 lattice_point(const Eigen::Vector3i& half_cells) const {
    return origin_ + 0.5 * cell_ * half_cells.cast<double>();
  }
  Values<8> distances(const PointBatch<8>& points, const Block& block) const {
    return sculpture_.distances(points, block.active);
  }

  /// Returns whether no surface lies within `radius` of a point at the distance `d`.
  bool is_clear(double d, double radius) const;

  Vec3 colour(const Vec3& x) const { return sculpture_.colour(x, active_at(x)); }
  /// Returns the value and the gradient, by differences over a small regular tetrahedron.
  double distance_and_gradient(const Vec3& x, Vec3& gradient) const;

 private:
  std::span<const int> active_at(const Vec3& x) const;

  const Sculpture& sculpture_;
  double cell_;
  Vec3 origin_;
  int blocks_per_side_ = 1;
  std::vector<int> everything_;
  std::vector<Block> blocks_;
  std::vector<std::array<int, 8>>
      children_;  // per inner node: child index, or -1 if empty; those of the last level are blocks
};

/// Returns smooth seeded value noise in [-1, 1], with one lattice cell per unit.
double noise(const Vec3& x, unsigned seed);
/// Returns a hash of the arguments, uniform in [0, 1).
double hash_unit(unsigned a, unsigned b, unsigned c, unsigned seed);

}  // namespace meshgraft::samples
