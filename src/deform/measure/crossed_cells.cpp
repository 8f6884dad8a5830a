#include "crossed_cells.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>

namespace meshgraft {

CrossedCells::CrossedCells(const Eigen::AlignedBox3d& box, std::uint64_t cell_count) : low_(box.min()) {
  // A flat box is one cell thick, and then has more cells along its other axes.
  const Eigen::Vector3d sizes = box.sizes();
  side_ = sizes.maxCoeff() / std::cbrt(static_cast<double>(cell_count));
  for (int time = 0; time < 8; ++time) {
    const Eigen::Vector3d cells = (sizes / side_).array().max(1.0);
    side_ *= std::cbrt(cells.prod() / static_cast<double>(cell_count));
  }
  if (!(side_ > 0)) side_ = 1;
  std::uint64_t count = 1;
  for (std::size_t k = 0; k < 3; ++k) {
    size_[k] = static_cast<std::int64_t>(sizes[static_cast<Eigen::Index>(k)] / side_) + 1;
    count *= static_cast<std::uint64_t>(size_[k]);
  }
  bits_.resize(count / 64 + 1);
}

CrossedCells::Cell CrossedCells::cell_at(const Eigen::Vector3d& in_cells) const {
  Cell cell;
  for (std::size_t k = 0; k < 3; ++k)
    cell[k] = static_cast<std::int64_t>(
        std::clamp(std::floor(in_cells[static_cast<Eigen::Index>(k)]), 0.0, static_cast<double>(size_[k] - 1)));
  return cell;
}

std::uint64_t CrossedCells::number_of(const Cell& cell) const {
  return static_cast<std::uint64_t>((cell[2] * size_[1] + cell[1]) * size_[0] + cell[0]);
}

// Goes from cell to cell (Amanatides and Woo 1987).
void CrossedCells::add_segment(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d start = (from - low_) / side_, way = (to - from) / side_;
  // The part [first, last] of the segment is within the grid.
  double first = 0, last = 1;
  for (Eigen::Index k = 0; k < 3; ++k) {
    const double limit = static_cast<double>(size_[static_cast<std::size_t>(k)]);
    if (way[k] == 0 && (start[k] < 0 || start[k] > limit)) return;
    if (way[k] == 0) continue;
    const double a = -start[k] / way[k], b = (limit - start[k]) / way[k];
    first = std::max(first, std::min(a, b));
    last = std::min(last, std::max(a, b));
  }
  if (!(first <= last)) return;

  Cell cell = cell_at(start + first * way);
  const Cell end = cell_at(start + last * way);
  std::array<std::int64_t, 3> step{};
  std::array<double, 3> next{}, between{};  // the part of the segment up to the next plane, and between planes
  std::int64_t steps = 0;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto axis = static_cast<Eigen::Index>(k);
    steps += std::abs(end[k] - cell[k]);
    step[k] = way[axis] < 0 ? -1 : 1;
    const double plane = static_cast<double>(cell[k] + (step[k] > 0 ? 1 : 0));
    const bool moves = way[axis] != 0;
    next[k] = moves ? (plane - start[axis]) / way[axis] : std::numeric_limits<double>::infinity();
    between[k] = moves ? 1 / std::abs(way[axis]) : std::numeric_limits<double>::infinity();
  }
  for (std::int64_t k = 0;; ++k) {
    const std::uint64_t number = number_of(cell), bit = std::uint64_t{1} << (number % 64);
    const std::atomic_ref<std::uint64_t> word(bits_[number / 64]);
    if ((word.load(std::memory_order_relaxed) & bit) == 0) word.fetch_or(bit, std::memory_order_relaxed);
    if (k == steps) return;
    std::size_t axis = 3;  // an axis along which the last cell is not reached yet
    for (std::size_t a = 0; a < 3; ++a)
      if (cell[a] != end[a] && (axis == 3 || next[a] < next[axis])) axis = a;
    cell[axis] += step[axis];
    next[axis] += between[axis];
  }
}

bool CrossedCells::may_meet(const Eigen::AlignedBox3d& box) const {
  constexpr double margin = 0.01;  // of a cell; far more than rounding
  constexpr std::int64_t most_cells = 64;
  const Eigen::Vector3d low = ((box.min() - low_) / side_).array() - margin;
  const Eigen::Vector3d high = ((box.max() - low_) / side_).array() + margin;
  if (!low.allFinite() || !high.allFinite()) return true;
  const Cell a = cell_at(low), b = cell_at(high);
  if ((b[0] - a[0] + 1) * (b[1] - a[1] + 1) * (b[2] - a[2] + 1) > most_cells) return true;
  for (std::int64_t z = a[2]; z <= b[2]; ++z)
    for (std::int64_t y = a[1]; y <= b[1]; ++y)
      for (std::int64_t x = a[0]; x <= b[0]; ++x) {
        const std::uint64_t number = number_of({x, y, z});
        if ((bits_[number / 64] >> (number % 64) & 1) != 0) return true;
      }
  return false;
}

}  // namespace meshgraft
