#include "intersecting_triangles.h"

#include <algorithm>
#include <cmath>
#include <mutex>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "bvh.h"
#include "core/parallel.h"
#include "core/stopwatch.h"
#include "triangle_intersection.h"

namespace meshgraft {

namespace {

using Vertices = std::array<Index, 3>;

Vertices vertices_of(const Triangles& triangles, Index t) {
  return {triangles(t, 0), triangles(t, 1), triangles(t, 2)};
}

Point3 point_of(const Points& points, Index v) { return {points(v, 0), points(v, 1), points(v, 2)}; }

Triangle3 corners_of(const Points& points, const Vertices& v) {
  return {point_of(points, v[0]), point_of(points, v[1]), point_of(points, v[2])};
}

BoundingBox box_of(const Triangle3& t) {
  BoundingBox box{t[0], t[0]};
  box.include(t[1]);
  box.include(t[2]);
  return box;
}

// Moves the vertices that both triangles share to the front of both. Returns the number of shared vertices.
int match_shared(Vertices& a, Vertices& b) {
  std::size_t shared = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto same = std::find(b.begin() + static_cast<std::ptrdiff_t>(shared), b.end(), a[i]);
    if (same == b.end()) continue;
    std::swap(a[shared], a[i]);
    std::swap(b[shared], *same);
    ++shared;
  }
  return static_cast<int>(shared);
}

// Returns whether two triangles with positive area intersect in more than their shared vertices and edges.
bool intersect(const Points& points, Vertices v, Vertices w) {
  const int shared = match_shared(v, w);
  return intersect_beyond_shared(corners_of(points, v), corners_of(points, w), shared);
}

// The slab between two parallel planes that contains some triangles. The boxes of sheets that lie close
// together overlap unless the sheets are aligned with an axis. Their slabs do not.
struct Slab {
  Eigen::RowVector3d normal{0, 0, 0};  // zero if the triangles are not flat enough
  double low = 0, high = 0;

  double height_of(const Point3& p) const { return normal[0] * p[0] + normal[1] * p[1] + normal[2] * p[2]; }

  // Returns whether all points lie on one side of the slab, by more than the rounding error.
  bool excludes(std::span<const Point3> points, double rounding) const {
    if (normal.isZero(0)) return false;
    double least = BoundingBox::infinity, largest = -least;
    for (const Point3& p : points) {
      const double height = height_of(p);
      least = std::min(least, height);
      largest = std::max(largest, height);
    }
    return least > high + rounding || largest < low - rounding;
  }
};

// Returns a bound, with a margin, on the rounding error of a difference of two heights within the box.
// Returns infinity if the heights overflow.
double rounding_of_heights(const BoundingBox& box) {
  double largest = 0;
  for (std::size_t k = 0; k < 3; ++k)
    largest = std::max({largest, std::abs(box.low[k]), std::abs(box.high[k])});
  return largest < 1e300 ? 0x1p-48 * largest + 1e-300 : BoundingBox::infinity;
}

// Returns the unit normal of a triangle, or zero if rounding dominates it.
Eigen::RowVector3d unit_normal(const Triangle3& t) {
  const auto edge = [&](std::size_t k) -> Eigen::RowVector3d {
    const Eigen::RowVector3d e(t[k][0] - t[0][0], t[k][1] - t[0][1], t[k][2] - t[0][2]);
    return e / e.cwiseAbs().maxCoeff();
  };
  const Eigen::RowVector3d normal = edge(1).cross(edge(2));
  const double length = normal.norm();
  return length > 0x1p-40 ? Eigen::RowVector3d(normal / length) : Eigen::RowVector3d::Zero();
}

// A surface with its free triangles in a bounding volume hierarchy. The other triangles are tested only near
// free ones.
class FreeSurface {
 public:
  FreeSurface(const Points& points, const Triangles& triangles, const Flags& free, const Context& context);

  std::size_t leaf_count() const { return static_cast<std::size_t>(tree_->first_leaf()); }
  std::size_t other_count() const { return others_.size(); }

  // Calls `found(pair)` for each pair of free triangles that intersect, with one in the given leaf and the
  // other in the same or a later leaf.
  template <class Found>
  void search_leaf(std::size_t k, const Found& found, const Context& context) const {
    const Bvh::Node leaf = tree_->first_leaf() + static_cast<Bvh::Node>(k);
    const Bvh::Range range = tree_->positions(leaf);
    std::array<Point3, 3 * Bvh::most_items_per_leaf> corners;
    std::size_t corner_count = 0;
    for (Index i = range.begin; i < range.end; ++i)
      for (const Point3& p : corners_of(points_, vertices_of(triangles_, free_triangle(i))))
        corners[corner_count++] = p;
    visit_near(tree_->box(leaf), {corners.data(), corner_count}, leaf, context, [&](Bvh::Node other) {
      for (Index i = range.begin; i < range.end; ++i)
        if (tree_->item_box(i).overlaps(tree_->box(other)))
          test_leaf(free_triangle(i), tree_->item_box(i), other, leaf == other ? i + 1 : 0, found);
    });
  }

  // Calls `found(pair)` for each free triangle that intersects the k-th triangle that is not free.
  template <class Found>
  void search_other(std::size_t k, const Found& found, const Context& context) const {
    const Triangle3 corners = corners_of(points_, vertices_of(triangles_, others_[k]));
    const BoundingBox box = box_of(corners);
    visit_near(box, corners, 0, context, [&](Bvh::Node leaf) {
      if (has_area(corners)) test_leaf(others_[k], box, leaf, 0, found);
    });
  }

 private:
  Index free_triangle(Index position) const { return free_[tree_->item(position)]; }
  const std::vector<Slab>& slabs(const Context& context) const;
  Slab slab_of(Bvh::Node node) const;

  // Calls `visit(leaf)` for leaves from `from` on whose triangles may intersect those in the box.
  template <class Visit>
  void visit_near(const BoundingBox& box, std::span<const Point3> corners, Bvh::Node from,
                  const Context& context, const Visit& visit) const {
    constexpr int usual_leaves = 48;  // leaves that a leaf's box overlaps on an uncrowded surface
    int leaves = 0;
    const auto enter = [&](Bvh::Node node) {
      if (leaves < usual_leaves) return true;
      const double rounding = std::max(rounding_, rounding_of_heights(box));
      return !slabs(context)[node].excludes(corners, rounding);
    };
    tree_->visit_leaves(box, from, enter, [&](Bvh::Node leaf) {
      ++leaves;
      context.throw_if_stopped();
      visit(leaf);
    });
  }

  // Tests a triangle against those of a leaf, starting at a position.
  template <class Found>
  void test_leaf(Index t, const BoundingBox& box, Bvh::Node leaf, Index from, const Found& found) const {
    const Bvh::Range range = tree_->positions(leaf);
    for (Index j = std::max(from, range.begin); j < range.end; ++j) {
      if (!box.overlaps(tree_->item_box(j))) continue;
      const Index other = free_triangle(j);
      if (intersect(points_, vertices_of(triangles_, t), vertices_of(triangles_, other)))
        found(std::array{std::min(t, other), std::max(t, other)});
    }
  }

  const Points& points_;
  const Triangles& triangles_;
  std::vector<Index> free_;          // free triangles with area
  std::vector<Index> others_;        // the others, of any area, within the box of `free_`
  std::optional<Bvh> tree_;          // hierarchy over `free_`
  double rounding_ = 0;              // bound for heights of free triangles
  mutable std::vector<Slab> slabs_;  // per node of the tree; made when first needed
  mutable std::once_flag slabs_made_;
};

FreeSurface::FreeSurface(const Points& points, const Triangles& triangles, const Flags& free,
                         const Context& context)
    : points_(points), triangles_(triangles) {
  // Returns the triangles that satisfy `belongs`, ascending.
  const auto triangles_where = [&](const auto& belongs) {
    Flags flags(free.size(), 0);
    parallel_blocks(
        free.size(),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t t = begin; t < end; ++t) flags[t] = belongs(static_cast<Index>(t));
        },
        context, 4096);
    std::vector<Index> found;
    for (std::size_t t = 0; t < flags.size(); ++t)
      if (flags[t]) found.push_back(static_cast<Index>(t));
    return found;
  };
  const auto corners = [&](Index t) { return corners_of(points, vertices_of(triangles, t)); };
  free_ = triangles_where([&](Index t) { return free[t] && has_area(corners(t)); });
  tree_.emplace(free_.size(), [&](std::size_t k) { return box_of(corners(free_[k])); }, context);
  const BoundingBox& around = tree_->box(Bvh::root);
  others_ = triangles_where([&](Index t) { return !free[t] && around.overlaps(box_of(corners(t))); });
  rounding_ = rounding_of_heights(around);
}

// Computes slabs of the leaves and of the third and sixth level above. Surfaces are seldom flat over larger
// nodes.
const std::vector<Slab>& FreeSurface::slabs(const Context& context) const {
  std::call_once(slabs_made_, [&] {
    std::vector<Slab> made(tree_->node_count());
    for (const int height : {0, 3, 6}) {
      const Bvh::Node first = tree_->first_leaf() >> height;
      parallel_blocks(
          first,
          [&](std::size_t begin, std::size_t end) {
            for (auto node = first + static_cast<Bvh::Node>(begin); node < first + static_cast<Bvh::Node>(end);
                 ++node)
              made[node] = slab_of(node);
          },
          context, 64);
    }
    slabs_ = std::move(made);
  });
  return slabs_;
}

Slab FreeSurface::slab_of(Bvh::Node node) const {
  const Bvh::Range range = tree_->positions(node);
  const auto corners = [&](Index k) { return corners_of(points_, vertices_of(triangles_, free_triangle(k))); };
  Slab slab;
  for (Index k = range.begin; k < range.end; ++k) {
    const Eigen::RowVector3d normal = unit_normal(corners(k));
    slab.normal += slab.normal.dot(normal) < 0 ? Eigen::RowVector3d(-normal) : normal;
  }
  const double length = slab.normal.norm();
  if (!(length > 0)) return {};
  slab.normal /= length;
  slab.low = BoundingBox::infinity;
  slab.high = -slab.low;
  for (Index k = range.begin; k < range.end; ++k)
    for (const Point3& p : corners(k)) {
      slab.low = std::min(slab.low, slab.height_of(p));
      slab.high = std::max(slab.high, slab.height_of(p));
    }
  constexpr double most_thickness = 0.25;  // × the longest side of the box
  const BoundingBox& box = tree_->box(node);
  const double extent =
      std::max({box.high[0] - box.low[0], box.high[1] - box.low[1], box.high[2] - box.low[2]});
  return slab.high - slab.low < most_thickness * extent ? slab : Slab{};
}

// Calls `search(k)` for all k below `count` in parallel and reports progress in long searches.
template <class Search>
void search_all(std::size_t count, const Search& search, const Context& context) {
  constexpr std::size_t least_slice = 64, most_slices = 64, grain = 16;
  constexpr double seconds_between_reports = 0.1;
  const std::size_t slice = std::max(least_slice, count / most_slices + 1);
  Stopwatch since_report;
  for (std::size_t first = 0; first < count; first += slice) {
    if (since_report.seconds() > seconds_between_reports) {
      context.step("intersections", static_cast<double>(first) / static_cast<double>(count));
      since_report = {};
    }
    parallel_blocks(
        std::min(slice, count - first),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) search(first + k);
        },
        context, grain);
  }
}

}  // namespace

bool intersect(const Points& points, const Triangles& triangles, const std::array<Index, 2>& pair) {
  const Vertices v = vertices_of(triangles, pair[0]), w = vertices_of(triangles, pair[1]);
  return has_area(corners_of(points, v)) && has_area(corners_of(points, w)) && intersect(points, v, w);
}

void find_intersections(const Points& points, const Triangles& triangles, const Flags& free,
                        const std::function<void(const std::array<Index, 2>&)>& found, const Context& context) {
  const FreeSurface surface(points, triangles, free, context);
  search_all(surface.leaf_count(), [&](std::size_t k) { surface.search_leaf(k, found, context); }, context);
  search_all(surface.other_count(), [&](std::size_t k) { surface.search_other(k, found, context); }, context);
}

}  // namespace meshgraft
