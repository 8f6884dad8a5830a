#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

namespace meshgraft {

/// The cells of a grid that some segments cross. It tells which parts of a surface the segments cannot meet.
class CrossedCells {
 public:
  /// Divides a box into at most about `cell_count` cubes. The box must be finite and not empty.
  CrossedCells(const Eigen::AlignedBox3d& box, std::uint64_t cell_count);

  /// Marks the cells that a segment crosses. Segments may be added by several threads at once.
  void add_segment(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

  /// Returns false only if no segment meets what the box holds within the grid. Boxes of many cells are not
  /// searched: for them it returns true.
  bool may_meet(const Eigen::AlignedBox3d& box) const;

 private:
  using Cell = std::array<std::int64_t, 3>;
  Cell cell_at(const Eigen::Vector3d& in_cells) const;
  std::uint64_t number_of(const Cell& cell) const;

  Eigen::Vector3d low_;
  double side_;
  Cell size_;                        ///< number of cells along each axis
  std::vector<std::uint64_t> bits_;  ///< one per cell
};

}  // namespace meshgraft
