#pragma once

#include <algorithm>
#include <random>
#include <utility>
#include <vector>

#include "linalg/direct/symbolic_factorisation.h"
#include "matrix_families.h"

namespace meshgraft {

inline std::vector<std::vector<int>> orders_of(Eigen::Index unknowns) {
  const std::vector<int> natural = numbers_below(unknowns);
  std::vector<int> backwards(natural.rbegin(), natural.rend()), random = natural;
  std::shuffle(random.begin(), random.end(), std::minstd_rand(2));
  return {natural, backwards, random};
}

/// Dissects sets of unknowns by halves of their numbers. A separator is the unknowns of the first half that are
/// coupled with the second.
class Halving {
 public:
  explicit Halving(const NormalMatrix& lower) : coupled_(full_matrix(lower).array() != 0) {
    dissection_.set_of.resize(lower.rows());
  }
  Dissection cut(int levels) {
    dissection_.parent[cut(numbers_below(coupled_.rows()), levels)] = -1;
    return std::move(dissection_);
  }

 private:
  int cut(std::vector<int> unknowns, int levels) {
    if (levels == 0) return add(std::move(unknowns));
    const auto middle = unknowns.begin() + static_cast<std::ptrdiff_t>(unknowns.size() / 2);
    const std::vector<int> right(middle, unknowns.end());
    std::vector<int> left, separator;
    std::partition_copy(
        unknowns.begin(), middle, std::back_inserter(separator), std::back_inserter(left),
        [&](int a) { return std::any_of(right.begin(), right.end(), [&](int b) { return coupled_(a, b); }); });
    const int first = cut(std::move(left), levels - 1), second = cut(right, levels - 1);
    return dissection_.parent[first] = dissection_.parent[second] = add(std::move(separator));
  }
  int add(std::vector<int> unknowns) {
    const int set = dissection_.sets();
    for (const int unknown : unknowns) dissection_.set_of[unknown] = set;
    dissection_.parent.push_back(-1);
    dissection_.unknowns.push_back(std::move(unknowns));
    return set;
  }

  Eigen::Array<bool, Eigen::Dynamic, Eigen::Dynamic> coupled_;
  Dissection dissection_;
};

inline std::vector<Dissection> dissections_of(const NormalMatrix& lower) {
  return {one_leaf(lower.rows()), Halving(lower).cut(1), Halving(lower).cut(3)};
}

/// Returns the patterns of a matrix for several dissections and several given orders.
inline std::vector<SupernodalPattern> patterns_of(const NormalMatrix& lower) {
  std::vector<SupernodalPattern> patterns;
  for (const Dissection& dissection : dissections_of(lower))
    patterns.push_back(symbolic_factorisation(lower, dissection, {}));
  for (const std::vector<int>& order : orders_of(lower.rows()))
    patterns.push_back(symbolic_factorisation(lower, order, {}));
  return patterns;
}

}  // namespace meshgraft
