#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "predicates.h"

namespace meshgraft {

/// A closed axis-aligned box, empty on construction.
struct BoundingBox {
  static constexpr double infinity = std::numeric_limits<double>::infinity();
  Point3 low{infinity, infinity, infinity};
  Point3 high{-infinity, -infinity, -infinity};

  void include(const BoundingBox& box) {
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], box.low[k]);
      high[k] = std::max(high[k], box.high[k]);
    }
  }
  void include(const Point3& p) { include(BoundingBox{p, p}); }
  /// Returns whether the boxes overlap or touch.
  bool overlaps(const BoundingBox& other) const {
    const auto along = [&](std::size_t k) {
      return int{low[k] <= other.high[k]} & int{other.low[k] <= high[k]};
    };
    return (along(0) & along(1) & along(2)) != 0;  // without branches
  }
};

/// Bounding volume hierarchy: a balanced binary tree of the boxes that bound its items. Each node is split at
/// the median along the longest side of the bounding box of its items' centres. The tree is the same for any
/// number of threads.
///
/// Nodes are numbered as in a heap: the root is 1, the children of i are 2i and 2i + 1. The items of a node
/// occupy a range of positions; items near each other in space have nearby positions. Boxes are stored as
/// doubles rather than quantised, so that an outlier does not reduce the precision of the others.
class Bvh {
 public:
  using Node = std::int64_t;
  static constexpr Index most_items_per_leaf = 8;
  struct Range {
    Index begin, end;
  };

  /// Builds the tree of `count` items. `box_of(k)` returns the box of item k, which must be finite; it is
  /// called twice for each, by several threads at once.
  Bvh(std::size_t count, const std::function<BoundingBox(std::size_t)>& box_of, const Context& context = {});

  Index size() const { return static_cast<Index>(items_.size()); }
  Index item(Index position) const { return items_[position]; }
  const BoundingBox& item_box(Index position) const { return item_boxes_[position]; }

  static constexpr Node root = 1;
  Node first_leaf() const { return Node{1} << depth_; }
  Node node_count() const { return 2 * first_leaf(); }  ///< including the unused node 0
  bool is_leaf(Node node) const { return node >= first_leaf(); }
  const BoundingBox& box(Node node) const { return node_boxes_[node]; }
  /// Returns the positions of the items below a node.
  Range positions(Node node) const;

  /// Calls `visit(leaf)`, in ascending order, for the leaves ≥ `from` whose boxes overlap `box`. Visits a
  /// leaf only if `enter(node)` is true for the leaf and all nodes above it.
  template <class Enter, class Visit>
  void visit_leaves(const BoundingBox& box, Node from, const Enter& enter, const Visit& visit) const {
    if (size() > 0) descend(root, depth_, box, from, enter, visit);
  }

 private:
  struct Entry;
  void order_items(const std::function<BoundingBox(std::size_t)>& box_of, const Context& context);
  void split(std::vector<Entry>& entries, Node node) const;

  template <class Enter, class Visit>
  void descend(Node node, int height, const BoundingBox& query, Node from, const Enter& enter,
               const Visit& visit) const {
    const Node last_leaf = ((node + 1) << height) - 1;
    if (last_leaf < from || !box(node).overlaps(query) || !enter(node)) return;
    if (height == 0) {
      visit(node);
      return;
    }
    descend(2 * node, height - 1, query, from, enter, visit);
    descend(2 * node + 1, height - 1, query, from, enter, visit);
  }

  int depth_ = 0;
  std::vector<Index> items_;             // by position
  std::vector<BoundingBox> item_boxes_;  // by position
  std::vector<BoundingBox> node_boxes_;  // by node
};

}  // namespace meshgraft
