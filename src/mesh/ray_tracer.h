#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/core/context.h>

namespace meshgraft {

using RayTriangle = std::array<Eigen::Vector3f, 3>;

/// A set of triangles, and the first of them that a ray meets. A ray never slips through between triangles that
/// share an edge. Results are the same for any number of threads.
class RayTracer {
 public:
  struct Hit {
    std::uint32_t triangle;  ///< its index
    float distance;          ///< from the origin, in lengths of the direction
    /// Barycentric coordinates: the point is (1 − u − v)·p0 + u·p1 + v·p2.
    float u, v;
  };

  /// Triangles with a coordinate that is not finite are left out.
  explicit RayTracer(const std::vector<RayTriangle>& triangles, const Context& context = {});

  /// Returns the nearest hit in front of the origin.
  std::optional<Hit> first_hit(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction) const;

  /// Returns whether the ray meets a triangle within `reach` lengths of the direction.
  bool blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction,
               float reach = std::numeric_limits<float>::infinity()) const;

 private:
  static constexpr int width = 4;
  using Lanes [[gnu::vector_size(sizeof(float) * width)]] = float;
  using Flags [[gnu::vector_size(sizeof(float) * width)]] = std::int32_t;

  /// An inner node: the boxes of its children, an empty one where there is none. A child is the index of a
  /// node, or of a pack if its highest bit is set.
  struct Node {
    std::array<Lanes, 6> planes;  ///< low x, y, z, high x, y, z
    std::array<std::uint32_t, width> children;
  };
  static constexpr std::uint32_t pack_bit = std::uint32_t{1} << 31;

  /// A leaf: up to four triangles, the rest NaN.
  struct Pack {
    std::array<std::array<Lanes, 3>, 3> corners;  ///< by corner, then coordinate
    std::array<std::uint32_t, width> triangles;
  };

  struct Ray;
  struct PackHit;
  struct Builder;

  Flags crossed(const Node& node, const Ray& ray, Lanes& near) const;
  PackHit meet(const Pack& pack, const Ray& ray) const;

  std::vector<Node> nodes_;
  std::vector<Pack> packs_;
};

}  // namespace meshgraft
