#include "delaunay_flips.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <Eigen/Geometry>

namespace meshgraft {

namespace {

constexpr double most_fold_cosine = 0.5;  // faces at up to 60° to each other

class Flipper {
 public:
  Flipper(const Points& points, Triangles& triangles) : points_(points), triangles_(triangles) {
    faces_at_.reserve(3 * triangles.rows());
    for (Index t = 0; t < triangles.rows(); ++t)
      for (int c = 0; c < 3; ++c) insert(corner(t, c), corner(t, c + 1), t);
  }

  void run() {
    std::vector<std::array<Index, 2>> stack;
    for (Index t = 0; t < triangles_.rows(); ++t)
      for (int c = 0; c < 3; ++c)
        if (corner(t, c) < corner(t, c + 1)) stack.push_back({corner(t, c), corner(t, c + 1)});
    // Each flip lowers the sum of squared edge lengths in a plane. On a bent surface that is not proven, so
    // the number of flips is bounded.
    std::size_t flips_left = 20 * stack.size();
    while (!stack.empty() && flips_left > 0) {
      const auto [a, b] = stack.back();
      stack.pop_back();
      std::array<Index, 2> apart;
      if (!try_flip(a, b, apart)) continue;
      --flips_left;
      for (const Index x : {a, b})
        for (const Index y : apart) stack.push_back({x, y});
    }
  }

 private:
  /// The number of faces of an undirected edge, and the face that runs along it in each direction (-1: none).
  /// They are in a hash table and not in an EdgeTable, because every flip takes an edge away and adds another.
  struct EdgeFaces {
    int count = 0;
    Index forward = -1, backward = -1;
  };

  Index corner(Index t, int c) const { return triangles_(t, c % 3); }
  static std::uint64_t key(Index a, Index b) {
    const auto [low, high] = std::minmax(a, b);
    return static_cast<std::uint64_t>(static_cast<std::uint32_t>(low)) << 32 | static_cast<std::uint32_t>(high);
  }
  void insert(Index a, Index b, Index t) {
    EdgeFaces& faces = faces_at_[key(a, b)];
    ++faces.count;
    (a < b ? faces.forward : faces.backward) = t;
  }
  void replace(Index a, Index b, Index t) {
    EdgeFaces& faces = faces_at_.at(key(a, b));
    (a < b ? faces.forward : faces.backward) = t;
  }
  Index opposite(Index t, Index a, Index b) const {
    for (int c = 0; c < 3; ++c)
      if (corner(t, c) != a && corner(t, c) != b) return corner(t, c);
    return -1;
  }
  double cotangent(Index apex, Index a, Index b) const {
    const Eigen::RowVector3d u = points_.row(a) - points_.row(apex), v = points_.row(b) - points_.row(apex);
    const double area = u.cross(v).norm();
    return area > 0 ? u.dot(v) / area : std::copysign(1e30, u.dot(v));
  }
  Eigen::RowVector3d area_vector(Index a, Index b, Index c) const {
    const Eigen::RowVector3d u = points_.row(b) - points_.row(a), v = points_.row(c) - points_.row(a);
    return u.cross(v);
  }

  bool try_flip(Index a, Index b, std::array<Index, 2>& apart) {
    const auto found = faces_at_.find(key(a, b));
    if (found == faces_at_.end()) return false;
    const auto [count, forward, backward] = found->second;
    if (count != 2 || forward < 0 || backward < 0) return false;
    if (a > b) std::swap(a, b);
    const Index c = opposite(forward, a, b), d = opposite(backward, a, b);
    if (c < 0 || d < 0 || c == d || faces_at_.contains(key(c, d))) return false;
    // The sine of the sum of both angles has the same sign as the sum of their cotangents.
    constexpr double rounding = 1e-9;
    if (cotangent(c, a, b) + cotangent(d, a, b) >= -rounding) return false;
    const Eigen::RowVector3d one = area_vector(a, b, c), other = area_vector(b, a, d);
    const Eigen::RowVector3d new_one = area_vector(c, d, b), new_other = area_vector(d, c, a);
    const auto along = [](const Eigen::RowVector3d& u, const Eigen::RowVector3d& v) {
      return u.dot(v) > most_fold_cosine * u.norm() * v.norm();
    };
    // Very narrow faces lie along sharp edges. Their normals are unreliable, so only the other face's normal
    // counts.
    constexpr double no_width = 0.02;
    const double length = (points_.row(a) - points_.row(b)).squaredNorm();
    const bool narrow = std::min(one.norm(), other.norm()) < no_width * length;
    const Eigen::RowVector3d mean = one + other;
    if ((!narrow && !along(one, other)) || !along(new_one, mean) || !along(new_other, mean)) return false;
    faces_at_.erase(found);
    triangles_.row(forward) << c, d, b;
    triangles_.row(backward) << d, c, a;
    insert(c, d, forward);
    insert(d, c, backward);
    replace(d, b, forward);
    replace(b, c, forward);
    replace(c, a, backward);
    replace(a, d, backward);
    apart = {c, d};
    return true;
  }

  const Points& points_;
  Triangles& triangles_;
  std::unordered_map<std::uint64_t, EdgeFaces> faces_at_;
};

}  // namespace

void flip_to_delaunay(const Points& points, Triangles& triangles) { Flipper(points, triangles).run(); }

}  // namespace meshgraft
