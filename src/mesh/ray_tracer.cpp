#include "ray_tracer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstddef>

#include <Eigen/Geometry>

#include "bvh.h"
#include "core/parallel.h"

namespace meshgraft {

namespace {

constexpr float infinite = std::numeric_limits<float>::infinity();
// Bounds the rounding of distances to the planes of a box, and of the corners that are projected along the ray.
constexpr float box_margin = 1.0f + 8 * std::numeric_limits<float>::epsilon();

template <typename Lanes>
Lanes smaller(Lanes a, Lanes b) {
  return a < b ? a : b;
}

template <typename Lanes>
Lanes larger(Lanes a, Lanes b) {
  return a > b ? a : b;
}

template <typename Flags>
bool any(const Flags& flags) {
  const auto halves = std::bit_cast<std::array<std::uint64_t, 2>>(flags);
  return (halves[0] | halves[1]) != 0;
}

}  // namespace

struct RayTracer::Ray {
  std::array<float, 3> origin, inverse;
  std::array<std::size_t, 3> near_planes, far_planes;
  std::size_t longest, second, third;  // axes, by the direction's longest component
  float shear_x, shear_y;              // take the direction to the longest axis
  float reach;

  Ray(const Eigen::Vector3f& from, const Eigen::Vector3f& towards, float length) : reach(length) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<Eigen::Index>(k);
      const float component = towards[axis];
      origin[k] = from[axis];
      inverse[k] = 1.0f / component;
      near_planes[k] = std::signbit(component) ? k + 3 : k;
      far_planes[k] = std::signbit(component) ? k : k + 3;
    }
    Eigen::Index axis = 0;
    towards.cwiseAbs().maxCoeff(&axis);
    longest = static_cast<std::size_t>(axis);
    second = (longest + 1) % 3;
    third = (longest + 2) % 3;
    shear_x = towards[static_cast<Eigen::Index>(second)] * inverse[longest];
    shear_y = towards[static_cast<Eigen::Index>(third)] * inverse[longest];
  }
};

struct RayTracer::PackHit {
  Flags hit;
  Lanes distance, u, v;
};

// Makes nodes of four children from the balanced binary tree. The tree's leaves are halved, so that each is a
// pack.
struct RayTracer::Builder {
  using Box = Eigen::AlignedBox3f;

  RayTracer& tracer;
  const std::vector<RayTriangle>& triangles;
  const std::vector<std::uint32_t>& finite;  // by item
  const Bvh& tree;
  std::vector<Box> boxes{};  // by pack

  int levels() const { return static_cast<int>(std::bit_width(static_cast<std::uint64_t>(tree.first_leaf()))); }

  // Appends what is below a node of the binary tree, and returns its index among nodes or packs.
  std::uint32_t append(Bvh::Node node, int level, Box& box) {
    const int below = levels() - level;
    if (below == 0) {
      const std::uint32_t pack = pack_of(node);
      box = boxes[pack];
      return pack | pack_bit;
    }
    const int step = below % 2 == 0 ? 2 : 1;
    const auto index = static_cast<std::uint32_t>(tracer.nodes_.size());
    tracer.nodes_.push_back(empty_node());
    for (std::size_t child = 0; child < std::size_t{1} << step; ++child) {
      Box child_box;
      const std::uint32_t at = append((node << step) + static_cast<Bvh::Node>(child), level + step, child_box);
      Node& written = tracer.nodes_[index];
      written.children[child] = at;
      for (std::size_t k = 0; k < 3; ++k) {
        written.planes[k][child] = child_box.min()[static_cast<Eigen::Index>(k)];
        written.planes[k + 3][child] = child_box.max()[static_cast<Eigen::Index>(k)];
      }
      box.extend(child_box);
    }
    return index;
  }

  static Node empty_node() {
    Node node{};
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t child = 0; child < width; ++child) {
        node.planes[k][child] = infinite;
        node.planes[k + 3][child] = -infinite;
      }
    return node;
  }

  // Packs are numbered as the halves of leaves.
  std::uint32_t pack_of(Bvh::Node half) const {
    return static_cast<std::uint32_t>(half - 2 * tree.first_leaf());
  }

  void make_packs(const Context& context) {
    const auto count = 2 * static_cast<std::size_t>(tree.first_leaf());
    tracer.packs_.resize(count);
    boxes.resize(count);
    parallel_blocks(
        count,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t pack = begin; pack < end; ++pack)
            tracer.packs_[pack] = make_pack(2 * tree.first_leaf() + static_cast<Bvh::Node>(pack), boxes[pack]);
        },
        context, 1024);
  }

  Pack make_pack(Bvh::Node half, Box& box) const {
    const auto items = half_of_leaf(half);
    Pack pack{};
    for (auto& corner : pack.corners)
      for (Lanes& coordinate : corner) coordinate = Lanes{} + std::numeric_limits<float>::quiet_NaN();
    for (std::size_t lane = 0; lane < items.size(); ++lane) {
      pack.triangles[lane] = items[lane];
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const Eigen::Vector3f& point = triangles[items[lane]][corner];
        box.extend(point);
        for (std::size_t k = 0; k < 3; ++k) pack.corners[corner][k][lane] = point[static_cast<Eigen::Index>(k)];
      }
    }
    return pack;
  }

  // Returns the triangles of a leaf's lower or upper half along the longest side of its centres' box.
  std::vector<std::uint32_t> half_of_leaf(Bvh::Node half) const {
    const Bvh::Range range = tree.positions(half / 2);
    std::vector<std::uint32_t> items;
    Box centres;
    for (Index position = range.begin; position < range.end; ++position) {
      items.push_back(finite[tree.item(position)]);
      centres.extend(centre(items.back()));
    }
    if (items.empty()) return items;
    Eigen::Index axis = 0;
    centres.sizes().maxCoeff(&axis);
    std::sort(items.begin(), items.end(), [&](std::uint32_t a, std::uint32_t b) {
      const float first = centre(a)[axis], second = centre(b)[axis];
      return first != second ? first < second : a < b;
    });
    const auto middle = items.begin() + static_cast<std::ptrdiff_t>((items.size() + 1) / 2);
    return half % 2 == 0 ? std::vector(items.begin(), middle) : std::vector(middle, items.end());
  }

  Eigen::Vector3f centre(std::uint32_t t) const {
    return (triangles[t][0] + triangles[t][1] + triangles[t][2]) / 3.0f;
  }
};

RayTracer::RayTracer(const std::vector<RayTriangle>& triangles, const Context& context) {
  meshgraft::Flags is_finite(triangles.size(), 0);
  parallel_blocks(
      triangles.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
          is_finite[t] = std::ranges::all_of(triangles[t], [](const auto& point) { return point.allFinite(); });
      },
      context, 4096);
  std::vector<std::uint32_t> finite;
  finite.reserve(triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t)
    if (is_finite[t]) finite.push_back(static_cast<std::uint32_t>(t));
  const auto box_of = [&](std::size_t item) {
    BoundingBox box;
    for (const Eigen::Vector3f& point : triangles[finite[item]])
      box.include(Point3{point.x(), point.y(), point.z()});
    return box;
  };
  const Bvh tree(finite.size(), box_of, context);
  nodes_.reserve(static_cast<std::size_t>(tree.first_leaf()));
  Builder builder{*this, triangles, finite, tree};
  builder.make_packs(context);
  Eigen::AlignedBox3f box;
  builder.append(Bvh::root, 0, box);
}

// Computes where the ray enters the boxes of a node's children, and which of them it crosses. If the direction
// has a component of zero, and the origin is in the plane of a side, the distance to that plane is NaN. A
// comparison with NaN is false, so the plane does not count.
inline RayTracer::Flags RayTracer::crossed(const Node& node, const Ray& ray, Lanes& near) const {
  near = Lanes{};
  Lanes far = Lanes{} + ray.reach;
  for (std::size_t k = 0; k < 3; ++k) {
    near = larger((node.planes[ray.near_planes[k]] - ray.origin[k]) * ray.inverse[k], near);
    far = smaller((node.planes[ray.far_planes[k]] - ray.origin[k]) * ray.inverse[k], far);
  }
  return near <= box_margin * far;
}

// Intersects a ray with four triangles (Woop, Benthin and Wald 2013). The corners are projected along the ray
// into a plane, where the ray is the origin; it meets a triangle if no edge has it on another side than the
// others. Rounding maps a corner to the same point in all of its triangles, and never turns the sign of u, v or
// w, but may make it zero.
inline RayTracer::PackHit RayTracer::meet(const Pack& pack, const Ray& ray) const {
  std::array<Lanes, 3> x, y, z;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto relative = [&](std::size_t axis) { return pack.corners[corner][axis] - ray.origin[axis]; };
    z[corner] = relative(ray.longest);
    x[corner] = relative(ray.second) - ray.shear_x * z[corner];
    y[corner] = relative(ray.third) - ray.shear_y * z[corner];
  }
  const Lanes u = x[2] * y[1] - y[2] * x[1], v = x[0] * y[2] - y[0] * x[2], w = x[1] * y[0] - y[1] * x[0];
  const Lanes total = u + v + w;
  const Lanes distance = (u * z[0] + v * z[1] + w * z[2]) * ray.inverse[ray.longest] / total;
  const Lanes lowest = smaller(smaller(u, v), w), highest = larger(larger(u, v), w);
  const Flags hit =
      ((lowest >= 0.0f) | (highest <= 0.0f)) & (total != 0.0f) & (distance >= 0.0f) & (distance <= ray.reach);
  return {hit, distance, v / total, w / total};
}

std::optional<RayTracer::Hit> RayTracer::first_hit(const Eigen::Vector3f& origin,
                                                   const Eigen::Vector3f& direction) const {
  if (packs_.empty() || !origin.allFinite() || !direction.allFinite()) return std::nullopt;
  Ray ray(origin, direction, infinite);
  struct Entry {
    std::uint32_t node;
    float near;
  };
  std::array<Entry, 64> stack;  // 32 levels of the binary tree are 16 levels of nodes
  std::size_t height = 0;
  stack[height++] = {nodes_.empty() ? pack_bit : 0, 0.0f};
  std::optional<Hit> nearest;
  while (height > 0) {
    const Entry entry = stack[--height];
    if (entry.near > box_margin * ray.reach) continue;
    if (entry.node & pack_bit) {
      const Pack& pack = packs_[entry.node & ~pack_bit];
      const PackHit found = meet(pack, ray);
      if (!any(found.hit)) continue;
      for (std::size_t lane = 0; lane < width; ++lane)
        if (found.hit[lane] && (!nearest || found.distance[lane] < nearest->distance)) {
          nearest = Hit{pack.triangles[lane], found.distance[lane], found.u[lane], found.v[lane]};
          ray.reach = found.distance[lane];
        }
      continue;
    }
    const Node& node = nodes_[entry.node];
    Lanes near;
    const Flags flags = crossed(node, ray, near);
    if (!any(flags)) continue;
    const std::size_t first = height;  // the nearest child comes last
    for (std::size_t child = 0; child < width; ++child) {
      if (!flags[child]) continue;
      std::size_t at = height++;
      for (; at > first && stack[at - 1].near < near[child]; --at) stack[at] = stack[at - 1];
      stack[at] = {node.children[child], near[child]};
    }
  }
  return nearest;
}

bool RayTracer::blocked(const Eigen::Vector3f& origin, const Eigen::Vector3f& direction, float reach) const {
  if (packs_.empty() || !origin.allFinite() || !direction.allFinite()) return false;
  const Ray ray(origin, direction, reach);
  std::array<std::uint32_t, 64> stack;
  std::size_t height = 0;
  stack[height++] = nodes_.empty() ? pack_bit : 0;
  while (height > 0) {
    const std::uint32_t entry = stack[--height];
    if (entry & pack_bit) {
      if (any(meet(packs_[entry & ~pack_bit], ray).hit)) return true;
      continue;
    }
    const Node& node = nodes_[entry];
    Lanes near;
    const Flags flags = crossed(node, ray, near);
    if (!any(flags)) continue;
    for (std::size_t child = 0; child < width; ++child)
      if (flags[child]) stack[height++] = node.children[child];
  }
  return false;
}

}  // namespace meshgraft
