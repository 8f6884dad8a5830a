#include "vertex_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

#define NANOFLANN_FIRST_MATCH  // the smallest index among points at the same distance
#include <nanoflann.hpp>

namespace meshgraft {

namespace {

// What nanoflann asks of a point set.
struct PointSet {
  const Points& positions;
  std::vector<Index> vertices;

  std::size_t kdtree_get_point_count() const { return vertices.size(); }
  double kdtree_get_pt(std::size_t k, std::size_t axis) const {
    return positions(vertices[k], static_cast<Eigen::Index>(axis));
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};

// What nanoflann asks of a place for results: those in a ball, unless there are more than a few.
struct FewInBall {
  double squared_radius = 0;
  std::array<std::uint32_t, 32> items{};
  std::size_t count = 0;
  bool overflow = false;

  bool full() const { return true; }
  double worstDist() const { return squared_radius; }
  bool addPoint(double, std::uint32_t k) {
    overflow = count == items.size();
    if (!overflow) items[count++] = k;
    return !overflow;
  }
};

}  // namespace

struct VertexTree::Tree {
  using Search = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, PointSet>, PointSet,
                                                     3, std::uint32_t>;
  PointSet points;
  Search search{3, points, nanoflann::KDTreeSingleIndexAdaptorParams(10)};

  void collect(const Eigen::RowVector3d& point, double radius, std::vector<Index>& found) const {
    std::vector<std::pair<std::uint32_t, double>> near;
    // The search takes the distance squared, and leaves out what is at it.
    const double squared = std::nextafter(radius * radius, 1e300);
    search.radiusSearch(point.data(), squared, near, nanoflann::SearchParams(32, 0, false));
    for (const auto& [k, distance] : near) found.push_back(points.vertices[k]);
  }

  // By balls around pieces of the way: the shorter the pieces, the less lies in the balls aside of it.
  void collect_near(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b, double reach,
                    std::vector<Index>& found) const {
    const Eigen::RowVector3d middle = (a + b) / 2;
    const double half = (b - a).norm() / 2, radius = half + reach;
    FewInBall few{.squared_radius = std::nextafter(radius * radius, 1e300)};
    search.findNeighbors(few, middle.data(), nanoflann::SearchParams());
    if (!few.overflow) {
      for (std::size_t i = 0; i < few.count; ++i) found.push_back(points.vertices[few.items[i]]);
      return;
    }
    const bool is_short = half <= 2 * reach || middle == a || middle == b;
    if (is_short) return collect(middle, radius, found);
    collect_near(a, middle, reach, found);
    collect_near(middle, b, reach, found);
  }
};

VertexTree::VertexTree(const Points& positions, std::vector<Index> vertices) {
  if (!vertices.empty()) tree_.reset(new Tree{{positions, std::move(vertices)}});
}

VertexTree::~VertexTree() = default;

std::optional<VertexTree::Found> VertexTree::nearest(const Eigen::RowVector3d& point) const {
  if (!tree_) return {};
  std::uint32_t k = 0;
  double squared = 0;
  tree_->search.knnSearch(point.data(), 1, &k, &squared);
  return Found{tree_->points.vertices[k], std::sqrt(squared)};
}

std::vector<Index> VertexTree::within(const Eigen::RowVector3d& point, double radius) const {
  std::vector<Index> found;
  if (tree_) tree_->collect(point, radius, found);
  std::sort(found.begin(), found.end());
  return found;
}

std::vector<Index> VertexTree::near_segment(const Eigen::RowVector3d& a, const Eigen::RowVector3d& b,
                                            double reach) const {
  std::vector<Index> found;
  if (tree_) tree_->collect_near(a, b, reach, found);
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace meshgraft
