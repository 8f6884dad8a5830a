#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include <meshgraft/mesh/mesh.h>

#include "core/memory_budget.h"
#include "core/platform/memory.h"
#include "io/charged.h"

namespace meshgraft::io {

/// Numbers points by their value in the order of first appearance. Equal points get one number (-0 equals 0),
/// and a point with a NaN gets its own.
///
/// The index is an open-addressing table of numbers, at most half full. A table with a node per point, like
/// std::unordered_map, takes several times as long and four times the memory.
template <class Real>
class PointIndex {
 public:
  using Point = std::array<Real, 3>;

  /// Charges the budget for the table, the points and their positions.
  PointIndex(std::size_t expected_points, MemoryBudget& budget) : budget_(budget) {
    reserve_charged(table_, std::bit_ceil(std::max<std::size_t>(2 * expected_points, 64)), budget_);
    platform::prefer_huge_pages(table_.data(), table_.capacity());
    table_.resize(table_.capacity(), empty);
  }

  /// Writes the number of each of `points` to `numbers`. At most 2^31 - 1 points can be told apart.
  void add(std::span<const Point> points, Index* numbers) {
    // Table and points are larger than the caches, so the entries that a block needs are prefetched together.
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
        if (number != empty) __builtin_prefetch(&point(number));
      }
      for (std::size_t i = 0; i < part.size(); ++i) *numbers++ = number_of(part[i], slots[i]);
      points = points.subspan(part.size());
    }
  }

  /// Returns the points in the order of their numbers. Frees the memory of the index meanwhile.
  Points take() {
    free_charged(table_, budget_);
    Points positions;
    resize_charged(positions, count_, budget_);
    platform::prefer_huge_pages(positions.data(), 3 * count_);
    double* to = positions.data();
    budget_.release((count_ + charged_size - 1) / charged_size * bytes_of_charge);
    std::size_t left = std::exchange(count_, 0);
    for (auto& points : blocks_) {
      const std::size_t size = std::min(left, block_size);
      for (std::size_t k = 0; k < size; ++k) to = std::copy(points[k].begin(), points[k].end(), to);
      left -= size;
      points.reset();
    }
    blocks_.clear();
    return positions;
  }

 private:
  using Bits = std::conditional_t<sizeof(Real) == 4, std::uint32_t, std::uint64_t>;
  static constexpr Index empty = -1;
  static constexpr std::size_t block_bits = 16, block_size = std::size_t{1} << block_bits;
  // Points are charged as they fill a block, because its untouched pages take no memory.
  static constexpr std::size_t charged_size = std::size_t{1} << 10,
                               bytes_of_charge = charged_size * sizeof(Point);

  Point& point(Index number) {
    const auto n = static_cast<std::size_t>(number);
    return blocks_[n >> block_bits][n & (block_size - 1)];
  }

  void push_back(const Point& value) {
    if (count_ % charged_size == 0) {
      budget_.charge(bytes_of_charge);
      // The positions come when the table has gone.
      const std::uint64_t of_positions = count_ * 3 * sizeof(double), of_table = table_.size() * sizeof(Index);
      if (of_positions > of_table) budget_.require(of_positions - of_table);
    }
    if (count_ % block_size == 0) blocks_.push_back(std::make_unique_for_overwrite<Point[]>(block_size));
    point(static_cast<Index>(count_++)) = value;
  }

  std::size_t slot_of(const Point& value) const {
    std::uint64_t hash = 0;
    for (const Real coordinate : value) {
      // Adding 0 turns -0 into 0. Multiplying moves differences to higher bits, and shifting moves them down
      // again.
      hash = (hash ^ std::bit_cast<Bits>(coordinate + Real{0})) * 0x9E3779B97F4A7C15u;
      hash ^= hash >> 32;
    }
    return static_cast<std::size_t>(hash) & (table_.size() - 1);
  }

  Index number_of(const Point& value, std::size_t slot) {
    const auto next = static_cast<Index>(count_);
    if (std::ranges::any_of(value, [](Real coordinate) { return std::isnan(coordinate); })) {
      push_back(value);
      return next;
    }
    for (;; slot = (slot + 1) & (table_.size() - 1)) {
      const Index number = table_[slot];
      if (number == empty) {
        table_[slot] = next;
        push_back(value);
        return next;
      }
      if (point(number) == value) return number;
    }
  }

  void reserve(std::size_t more) {
    if (2 * (count_ + more) <= table_.size()) return;
    const std::size_t size = 2 * table_.size();
    table_.clear();
    resize_charged(table_, size, empty, budget_);
    for (Index p = 0; p < static_cast<Index>(count_); ++p) {
      const Point& value = point(p);
      if (std::ranges::any_of(value, [](Real coordinate) { return std::isnan(coordinate); })) continue;
      std::size_t slot = slot_of(value);
      while (table_[slot] != empty) slot = (slot + 1) & (table_.size() - 1);
      table_[slot] = p;
    }
  }

  MemoryBudget& budget_;
  // The points are in blocks, so that growing copies nothing and `take` can free them one by one.
  std::vector<std::unique_ptr<Point[]>> blocks_;
  std::size_t count_ = 0;
  std::vector<Index> table_;  // vertex numbers or `empty`; the size is a power of two
};

}  // namespace meshgraft::io
