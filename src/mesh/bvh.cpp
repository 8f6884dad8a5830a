#include "bvh.h"

#include <bit>
#include <cstddef>

#include "core/parallel.h"

namespace meshgraft {

struct Bvh::Entry {
  Point3 centre;
  Index item;
};

namespace {

int depth_for(std::size_t items) {
  int depth = 0;
  while ((static_cast<std::size_t>(Bvh::most_items_per_leaf) << depth) < items) ++depth;
  return depth;
}

}  // namespace

Bvh::Range Bvh::positions(Node node) const {
  const int level = static_cast<int>(std::bit_width(static_cast<std::uint64_t>(node))) - 1;
  const Node in_level = node - (Node{1} << level);
  const auto begin = [&](Node k) { return static_cast<Index>((size() * k) >> level); };
  return {begin(in_level), begin(in_level + 1)};
}

Bvh::Bvh(std::size_t count, const std::function<BoundingBox(std::size_t)>& box_of, const Context& context)
    : depth_(depth_for(count)), items_(count) {
  order_items(box_of, context);
  item_boxes_.resize(count);
  node_boxes_.resize(std::size_t{2} << depth_);
  parallel_blocks(
      first_leaf(),
      [&](std::size_t begin, std::size_t end) {
        for (Node leaf = first_leaf() + static_cast<Node>(begin); leaf < first_leaf() + static_cast<Node>(end);
             ++leaf) {
          const Range range = positions(leaf);
          for (auto k = static_cast<std::size_t>(range.begin); k < static_cast<std::size_t>(range.end); ++k) {
            item_boxes_[k] = box_of(static_cast<std::size_t>(items_[k]));
            node_boxes_[leaf].include(item_boxes_[k]);
          }
        }
      },
      context);
  for (std::size_t node = static_cast<std::size_t>(first_leaf()) - 1; node >= 1; --node) {
    node_boxes_[node] = node_boxes_[2 * node];
    node_boxes_[node].include(node_boxes_[2 * node + 1]);
  }
}

// Sorts the items to their positions. Its working memory is given back before the boxes need theirs.
void Bvh::order_items(const std::function<BoundingBox(std::size_t)>& box_of, const Context& context) {
  std::vector<Entry> entries(items_.size());
  parallel_blocks(
      entries.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) {
          const BoundingBox box = box_of(k);
          for (std::size_t axis = 0; axis < 3; ++axis)
            entries[k].centre[axis] = box.low[axis] / 2 + box.high[axis] / 2;
          entries[k].item = static_cast<Index>(k);
        }
      },
      context, 4096);

  // Large nodes are split level by level. Small subtrees follow one after another, each while it fits in the
  // cache.
  constexpr int shared_levels = 7;
  const auto split_nodes = [&](Node first, Node count, const auto& work) {
    parallel_blocks(
        count,
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t k = begin; k < end; ++k) work(first + static_cast<Node>(k));
        },
        context, 1);
  };
  const int levels = std::min(depth_, shared_levels);
  for (int level = 0; level < levels; ++level)
    split_nodes(Node{1} << level, Node{1} << level, [&](Node node) { split(entries, node); });
  split_nodes(Node{1} << levels, Node{1} << levels, [&](Node subtree) {
    for (int height = 0; levels + height < depth_; ++height)
      for (Node node = subtree << height; node < (subtree + 1) << height; ++node) split(entries, node);
  });

  parallel_blocks(
      entries.size(),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t k = begin; k < end; ++k) items_[k] = entries[k].item;
      },
      context, 4096);
}

// Splits a node's items at their median.
void Bvh::split(std::vector<Entry>& entries, Node node) const {
  const Range range = positions(node);
  BoundingBox centres;
  for (Index k = range.begin; k < range.end; ++k) centres.include(entries[k].centre);
  std::size_t axis = 0;
  const auto extent = [&](std::size_t k) { return centres.high[k] / 2 - centres.low[k] / 2; };
  for (std::size_t k = 1; k < 3; ++k)
    if (extent(k) > extent(axis)) axis = k;
  std::nth_element(entries.begin() + range.begin, entries.begin() + positions(2 * node).end,
                   entries.begin() + range.end,
                   [axis](const Entry& a, const Entry& b) { return a.centre[axis] < b.centre[axis]; });
}

}  // namespace meshgraft
