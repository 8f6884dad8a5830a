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

/// How a stroke joins what was modelled before it.
struct Brush {
  Vec3 colour{0.80, 0.76, 0.70};  ///< sRGB, 0 … 1
  double blend = 0.05;            ///< radius of the fillet between the stroke and the rest, model units
  bool carve = false;             ///< take the stroke's volume away instead of adding it
};

/// A point of a chain: the axis passes through `point`, the surface is `radius` away.
struct Knot {
  Vec3 point;
  double radius;
};

/// Lengthwise ribs of a chain.
struct Ribs {
  int count = 0;
  double depth_rel = 0.0;  ///< depth of the grooves, × the chain's radius
};

/// A solid modelled as an ordered list of strokes (ellipsoids, chains of cones, rings, half-spaces), each
/// blended into or carved out of what is there; described by an approximate signed distance, negative inside.
class Sculpture {
 public:
  void ellipsoid(const Vec3& centre, const Vec3& radii, const Brush& brush,
                 const Eigen::Matrix3d& axes = Eigen::Matrix3d::Identity());
  void chain(std::span<const Knot> knots, const Brush& brush, const Ribs& ribs = {});
  /// A torus; `axis` need not be of unit length.
  void ring(const Vec3& centre, const Vec3& axis, double radius, double thickness, const Brush& brush);
  /// The points with normal·(x − point) < 0.
  void half_space(const Vec3& point, const Vec3& normal, const Brush& brush);
  /// Adds a height field on the finished surface: |relief| ≤ amplitude.
  void set_relief(std::function<double(const Vec3&)> relief, double amplitude);

  std::size_t stroke_count() const { return strokes_.size(); }
  /// A box that holds the added strokes.
  void bounds(Vec3& low, Vec3& high) const;

  /// Signed distance, with only the strokes in `active` (ascending).
  double distance(const Vec3& x, std::span<const int> active) const;
  /// The strokes' colours, mixed where they blend.
  Vec3 colour(const Vec3& x, std::span<const int> active) const;

  /// Of `active`, the strokes that can change the surface within `radius` of `centre`.
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

  /// 0 on a rib's crest … 1 at the bottom of a groove.
  static double rib_depth(const Stroke& stroke, const Vec3& radial, double length);
  static double stroke_distance(const Stroke& stroke, const Vec3& x);

  std::vector<Stroke> strokes_;
  std::function<double(const Vec3&)> relief_;
  double relief_amplitude_ = 0.0;
  int groups_ = 0;
};

/// A sculpture prepared for fast evaluation near its surface: an octree whose leaves, blocks of 2×2×2 lattice
/// cells, exist where the surface passes and know the few strokes that matter there.
class SparseField {
 public:
  static constexpr int block_cells = 2;
  struct Block {
    Eigen::Vector3i position;  // in blocks
    std::vector<int> active;
  };

  SparseField(const Sculpture& sculpture, double cell, const Context& context);

  const std::vector<Block>& blocks() const { return blocks_; }
  int cells_per_side() const { return blocks_per_side_ * block_cells; }
  /// A point of the lattice; coordinates in half cells.
  Vec3 lattice_point(const Eigen::Vector3i& half_cells) const {
    return origin_ + 0.5 * cell_ * half_cells.cast<double>();
  }
  double distance(const Vec3& x, const Block& block) const { return sculpture_.distance(x, block.active); }

  Vec3 colour(const Vec3& x) const { return sculpture_.colour(x, active_at(x)); }
  /// Value and gradient by differences over a small regular tetrahedron.
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
      children_;  // of the inner nodes; -1 = nothing there; the last level's are blocks
};

/// Seeded value noise, smooth, in [-1, 1]; one lattice cell per unit.
double noise(const Vec3& x, unsigned seed);
/// Uniform in [0, 1), a hash of its arguments.
double hash_unit(unsigned a, unsigned b, unsigned c, unsigned seed);

}  // namespace meshgraft::samples
