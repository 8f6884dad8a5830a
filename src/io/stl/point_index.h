#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "io/file.h"

namespace meshgraft::io {

/// Numbers points by their value in order of first appearance: equal points (-0 equals 0) get one number, a
/// point with a NaN one of its own. An open-addressing table of numbers, at most half full; a table of
/// std::unordered_map's kind, with a node per point, takes several times as long and four times the memory.
template <class Real>
class PointIndex {
 public:
  using Point = std::array<Real, 3>;

  explicit PointIndex(std::size_t expected_points) {
    points_.reserve(expected_points);
    table_.reserve(std::bit_ceil(std::max<std::size_t>(2 * expected_points, 64)));
    prefer_huge_pages(points_.data(), points_.capacity());
    prefer_huge_pages(table_.data(), table_.capacity());
    table_.resize(table_.capacity(), empty);
  }

  /// The numbers of `points`, in their order. At most 2^31 - 1 points can be told apart.
  void add(std::span<const Point> points, Index* numbers) {
    // Table and points are larger than the caches: what a block needs of them is fetched together.
    constexpr std::size_t block = 32;
    while (!points.empty()) {
      const auto part = points.first(std::min(block, points.size()));
      reserve(part.size());
      std::array<std::size_t, block> slots;
      for (std::size_t i = 0; i < part.size(); ++i) {
        slots[i] = slot_of(part[i]);
        __builtin_prefetch(table_.data() + slots[i]);
      }
      for (std::size_t i = 0; i < part.size(); ++i) {
        const Index number = table_[slots[i]];
        if (number != empty) __builtin_prefetch(points_.data() + number);
      }
      for (std::size_t i = 0; i < part.size(); ++i) *numbers++ = number_of(part[i], slots[i]);
      points = points.subspan(part.size());
    }
  }

  /// The points in the order of their numbers; the table goes.
  const std::vector<Point>& finish() {
    table_ = {};
    return points_;
  }

 private:
  static constexpr Index empty = -1;
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;

  std::size_t slot_of(const Point& point) const {
    std::uint64_t hash = 0;
    for (const Real coordinate : point) {
      // Adding 0 makes -0 into 0. Multiplying moves differences up, shifting brings them down again.
      hash = (hash ^ std::bit_cast<Bits>(coordinate + Real{0})) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash) & (table_.size() - 1);
  }

  Index number_of(const Point& point, std::size_t slot) {
    const auto next = static_cast<Index>(points_.size());
    if (std::ranges::any_of(point, [](Real coordinate) { return std::isnan(coordinate); })) {
      points_.push_back(point);
      return next;
    }
    for (;; slot = (slot + 1) & (table_.size() - 1)) {
      const Index number = table_[slot];
      if (number == empty) {
        table_[slot] = next;
        points_.push_back(point);
        return next;
      }
      if (points_[static_cast<std::size_t>(number)] == point) return number;
    }
  }

  void reserve(std::size_t more) {
    if (2 * (points_.size() + more) <= table_.size()) return;
    table_.assign(2 * table_.size(), empty);
    for (std::size_t p = 0; p < points_.size(); ++p) {
      if (std::ranges::any_of(points_[p], [](Real coordinate) { return std::isnan(coordinate); })) continue;
      std::size_t slot = slot_of(points_[p]);
      while (table_[slot] != empty) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = static_cast<Index>(p);
    }
  }

  std::vector<Point> points_;
  std::vector<Index> table_;  // a power of two
};

}  // namespace meshgraft::io
