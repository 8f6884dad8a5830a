#include "../../src/mesh/bvh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace meshgraft::test {
namespace {

using Boxes = std::vector<BoundingBox>;

Bvh tree_of(const Boxes& boxes, const Context& context = {}) {
  return Bvh(boxes.size(), [&](std::size_t k) { return boxes[k]; }, context);
}
using Pairs = std::vector<std::pair<Index, Index>>;

struct Family {
  std::string name;
  Boxes boxes;
};

Boxes random_boxes(int count, double size, std::mt19937_64& random) {
  std::uniform_real_distribution<double> coordinate(-1, 1);
  Boxes boxes(static_cast<std::size_t>(count));
  for (BoundingBox& box : boxes)
    for (int corner = 0; corner < 2; ++corner) {
      const double scale = corner == 0 ? 1 : size;
      Point3 p = corner == 0 ? Point3{} : box.low;
      for (double& x : p) x += scale * coordinate(random);
      box.include(p);
    }
  return boxes;
}

std::vector<Family> families() {
  std::mt19937_64 random(9);
  std::vector<Family> all{{"none", {}}};
  for (const int count : {1, 2, 8, 9, 17, 100, 1500})
    for (const double size : {0.0, 0.05, 2.0})
      all.push_back(
          {std::to_string(count) + " boxes of " + std::to_string(size), random_boxes(count, size, random)});
  all.push_back({"the same box", Boxes(60, {{1, 2, 3}, {4, 5, 6}})});
  Boxes grid;  // boxes that touch
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      for (int k = 0; k < 6; ++k) grid.push_back({{1.0 * i, 1.0 * j, 1.0 * k}, {i + 1.0, j + 1.0, k + 1.0}});
  all.push_back({"grid", grid});
  Boxes stray = random_boxes(300, 0.1, random);
  stray.push_back({{1e300, -1e300, 0}, {1.1e300, -1e299, 1}});
  all.push_back({"a stray one", stray});
  for (const double scale : {1e-310, 1e300}) {
    Boxes scaled = random_boxes(200, 0.2, random);
    for (BoundingBox& box : scaled)
      for (Point3* p : {&box.low, &box.high})
        for (double& x : *p) x *= scale;
    all.push_back({"scaled", scaled});
  }
  return all;
}

Pairs overlaps_found(const Bvh& bvh, const Boxes& boxes) {
  Pairs pairs;
  for (std::size_t k = 0; k < boxes.size(); ++k)
    bvh.visit_leaves(
        boxes[k], 0, [](Bvh::Node) { return true; },
        [&](Bvh::Node leaf) {
          for (Index j = bvh.positions(leaf).begin; j < bvh.positions(leaf).end; ++j)
            if (boxes[k].overlaps(bvh.item_box(j))) pairs.emplace_back(static_cast<Index>(k), bvh.item(j));
        });
  std::sort(pairs.begin(), pairs.end());
  return pairs;
}

TEST(Bvh, FindsTheBoxesThatOverlapAndNoOthers) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    Pairs expected;
    for (std::size_t i = 0; i < family.boxes.size(); ++i)
      for (std::size_t j = 0; j < family.boxes.size(); ++j)
        if (family.boxes[i].overlaps(family.boxes[j]))
          expected.emplace_back(static_cast<Index>(i), static_cast<Index>(j));
    EXPECT_EQ(overlaps_found(tree_of(family.boxes), family.boxes), expected);
  }
}

TEST(Bvh, LeavesShareOutTheItems) {
  for (const Family& family : families()) {
    SCOPED_TRACE(family.name);
    const Bvh bvh = tree_of(family.boxes);
    Index next = 0;
    std::vector<Index> items;
    for (Bvh::Node leaf = bvh.first_leaf(); leaf < bvh.node_count(); ++leaf) {
      const auto [begin, end] = bvh.positions(leaf);
      EXPECT_EQ(begin, next);
      EXPECT_LE(end - begin, Bvh::most_items_per_leaf);
      EXPECT_GE(end - begin, std::min(bvh.size(), Bvh::most_items_per_leaf / 2));
      next = end;
      for (Index k = begin; k < end; ++k) items.push_back(bvh.item(k));
    }
    EXPECT_EQ(next, bvh.size());
    std::sort(items.begin(), items.end());
    for (std::size_t k = 0; k < items.size(); ++k) EXPECT_EQ(items[k], static_cast<Index>(k));
  }
}

TEST(Bvh, VisitsLeavesInOrderFromTheOneAskedForAndNoneBelowAClosedNode) {
  std::mt19937_64 random(3);
  const Bvh bvh = tree_of(random_boxes(500, 0.1, random));
  const BoundingBox everything{{-9, -9, -9}, {9, 9, 9}};
  std::vector<Bvh::Node> seen;
  const auto see = [&](Bvh::Node leaf) { seen.push_back(leaf); };
  const Bvh::Node from = bvh.first_leaf() + 11;
  bvh.visit_leaves(everything, from, [](Bvh::Node) { return true; }, see);
  EXPECT_EQ(seen.front(), from);
  EXPECT_EQ(seen.back(), bvh.node_count() - 1);
  EXPECT_EQ(std::ssize(seen), bvh.node_count() - from);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));

  seen.clear();
  bvh.visit_leaves(everything, 0, [](Bvh::Node node) { return node != 3; }, see);
  EXPECT_EQ(seen.front(), bvh.first_leaf());
  EXPECT_EQ(std::ssize(seen), (bvh.node_count() - bvh.first_leaf()) / 2);
}

TEST(Bvh, TheNumberOfThreadsDoesNotMatter) {
  std::mt19937_64 random(4);
  const Boxes boxes = random_boxes(20'000, 0.05, random);
  const Bvh one = tree_of(boxes, {.threads = 1});
  for (const int threads : {0, 2}) {
    const Bvh other = tree_of(boxes, {.threads = threads});
    for (Index k = 0; k < one.size(); ++k) ASSERT_EQ(other.item(k), one.item(k));
    for (Bvh::Node node = 1; node < one.node_count(); ++node) {
      ASSERT_EQ(other.box(node).low, one.box(node).low);
      ASSERT_EQ(other.box(node).high, one.box(node).high);
    }
  }
}

}  // namespace
}  // namespace meshgraft::test
