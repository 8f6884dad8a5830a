#include "mesh/disjoint_sets.h"

#include <algorithm>
#include <random>

#include <gtest/gtest.h>

namespace meshgraft {
namespace {

TEST(DisjointSets, HaveTheirSmallestElementsAsRoots) {
  std::mt19937 random(1);
  for (const Index count : {1, 2, 10, 200}) {
    DisjointSets sets(count);
    std::vector<Index> smallest(count);  // per element: the smallest of its set
    std::iota(smallest.begin(), smallest.end(), 0);
    for (Index k = 0; k < count; ++k) {
      const Index a = static_cast<Index>(random() % count), b = static_cast<Index>(random() % count);
      sets.unite(a, b);
      const auto [low, high] = std::minmax({smallest[a], smallest[b]});
      std::replace(smallest.begin(), smallest.end(), high, low);
      for (Index i = 0; i < count; ++i) ASSERT_EQ(sets.root(i), smallest[i]);
    }
  }
}

}  // namespace
}  // namespace meshgraft
