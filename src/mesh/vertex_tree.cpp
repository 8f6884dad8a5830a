#include "vertex_tree.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#define NANOFLANN_FIRST_MATCH  // the smallest index among points at the same distance
#include <nanoflann.hpp>

namespace meshgraft {

namespace {

// The interface that nanoflann requires of a point set.
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

// A straight segment, with parameters from 0 to 1.
struct Segment {
  Eigen::RowVector3d from, along;
  double per_length = along.isZero(0) ? 0 : 1 / along.squaredNorm();  // squared

  // Clips [begin, end] to where a coordinate is at most (or at least) `bound`; begin > end means empty.
  void clip(int axis, double bound, bool at_most, double& begin, double& end) const {
    const double start = from[axis] - bound, speed = along[axis];
    if (speed == 0) {
      if (at_most ? start > 0 : start < 0) end = begin - 1;
      return;
    }
    const double t = -start / speed;
    if ((speed > 0) == at_most)
      end = std::min(end, t);
    else
      begin = std::max(begin, t);
  }

  double squared_distance(const Eigen::RowVector3d& point) const {
    const double t = std::clamp((point - from).dot(along) * per_length, 0.0, 1.0);
    return (point - from - t * along).squaredNorm();
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
    // The search takes a squared distance and excludes points exactly at it.
    const double squared = std::nextafter(radius * radius, 1e300);
    search.radiusSearch(point.data(), squared, near, nanoflann::SearchParams(32, 0, false));
    for (const auto& [k, distance] : near) found.push_back(points.vertices[k]);
  }

  // Descends to the leaves near the segment, with the segment clipped to each side. nanoflann searches only
  // around points, and a ball around a long segment contains far more vertices than lie near it.
  void collect_near(const Search::Node* node, const Segment& segment, double begin, double end, double radius,
                    std::vector<Index>& found) const {
    if (!(begin <= end)) return;
    if (node->child1 == nullptr) {
      for (auto i = node->node_type.lr.left; i < node->node_type.lr.right; ++i) {
        const Index v = points.vertices[search.vAcc[i]];
        if (segment.squared_distance(points.positions.row(v)) <= radius * radius) found.push_back(v);
      }
      return;
    }
    const auto& cut = node->node_type.sub;
    double low_begin = begin, low_end = end;
    segment.clip(cut.divfeat, cut.divlow + radius, true, low_begin, low_end);
    collect_near(node->child1, segment, low_begin, low_end, radius, found);
    segment.clip(cut.divfeat, cut.divhigh - radius, false, begin, end);
    collect_near(node->child2, segment, begin, end, radius, found);
  }
};

VertexTree::VertexTree(const Points& positions, std::vector<Index> vertices) {
  if (!vertices.empty())
    tree_.reset(new Tree{{positions, std::move(vertices)}});  // NOLINT(modernize-make-unique): an aggregate
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
                                            double radius) const {
  std::vector<Index> found;
  // Rounding may place a vertex slightly beside a segment on which it lies.
  constexpr double rounding = 1e-14;
  const double widened = radius + rounding * (a.cwiseAbs() + b.cwiseAbs()).maxCoeff();
  if (tree_) tree_->collect_near(tree_->search.root_node, {a, b - a}, 0, 1, widened, found);
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace meshgraft
