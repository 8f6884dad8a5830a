#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/linalg/linear_solver.h>
#include <meshgraft/mesh/mesh.h>

#include "linalg/sparse.h"

namespace meshgraft {

/// A dense matrix in single precision with a row per vertex that moves. Its layout makes products with few
/// columns fast. Rows are stored in blocks, and each column's numbers of a block are contiguous.
class ResponseColumns {
 public:
  ResponseColumns() = default;
  /// `vertices` are those with rows, ascending.
  ResponseColumns(std::vector<Index> vertices, std::size_t columns, const Context& context = {});

  /// Sets some columns to those of `values`, which has a row per vertex.
  void set(std::span<const std::size_t> columns, const Columns& values, const Context& context);

  /// Sets positions.row(v) = base.row(v) + scale · (row of v) · coefficients (columns×3) for vertices with
  /// rows. Copies base.row(v) for all others.
  void place(const Columns& coefficients, double scale, const Points& base, PointsRef positions,
             const Context& context) const;

  const std::vector<Index>& vertices() const { return vertices_; }
  std::int64_t memory_bytes() const;

 private:
  static constexpr std::size_t lanes = 8;
  std::size_t block_count() const { return (vertices_.size() + lanes - 1) / lanes; }
  std::size_t value_count() const { return block_count() * columns_ * lanes; }
  void place_block(std::size_t block, const std::vector<float>& coefficients, double scale,
                   PointsRef positions) const;

  std::vector<Index> vertices_;
  std::size_t columns_ = 0;
  std::unique_ptr<float[]> values_;  ///< [block][column][vertex of the block]
};

}  // namespace meshgraft
