#pragma once

#include <numeric>
#include <vector>

#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Union-find over 0 … count-1. A set's root is its smallest element.
class DisjointSets {
 public:
  explicit DisjointSets(Index count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0); }

  Index root(Index i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }

  void unite(Index a, Index b) {
    a = root(a);
    b = root(b);
    (a < b ? parent_[b] : parent_[a]) = a < b ? a : b;
  }

 private:
  std::vector<Index> parent_;
};

}  // namespace meshgraft
