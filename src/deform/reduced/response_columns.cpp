#include "response_columns.h"

#include <algorithm>
#include <utility>

#include "core/parallel.h"
#include "short_numbers.h"

namespace meshgraft {

ResponseColumns::ResponseColumns(std::vector<Index> vertices, std::size_t columns, const Context& context)
    : vertices_(std::move(vertices)), columns_(columns), values_(new float[value_count()]) {
  const auto clear = [&](std::size_t begin, std::size_t end) {
    std::fill_n(values_.get() + begin * columns_ * lanes, (end - begin) * columns_ * lanes, 0.0F);
  };
  parallel_blocks(block_count(), clear, context, 256);
}

void ResponseColumns::set(std::span<const std::size_t> columns, const Columns& values, const Context& context) {
  const auto set_rows = [&](std::size_t begin, std::size_t end) {
    for (std::size_t k = begin; k < end; ++k)
      for (std::size_t c = 0; c < columns.size(); ++c)
        values_[(k / lanes * columns_ + columns[c]) * lanes + k % lanes] =
            short_number(values(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(c)));
  };
  parallel_blocks(vertices_.size(), set_rows, context, 1024);
}

void ResponseColumns::place(const Columns& coefficients, double scale, const Points& base, PointsRef positions,
                            const Context& context) const {
  const std::size_t blocks = block_count();
  std::vector<float> numbers;
  for (const double number : coefficients.reshaped<Eigen::RowMajor>()) numbers.push_back(short_number(number));
  const auto run = [&](std::size_t begin, std::size_t end) {
    // The range holds the block's vertices and all others up to the next block's first vertex.
    const Eigen::Index from = begin == 0 ? 0 : vertices_[begin * lanes];
    const Eigen::Index to = end == blocks ? base.rows() : vertices_[end * lanes];
    positions.middleRows(from, to - from) = base.middleRows(from, to - from);
    for (std::size_t block = begin; block < end; ++block) place_block(block, numbers, scale, positions);
  };
  if (blocks > 0)
    parallel_blocks(blocks, run, context, 256);
  else
    positions = base;
}

void ResponseColumns::place_block(std::size_t block, const std::vector<float>& coefficients, double scale,
                                  PointsRef positions) const {
  const auto sums = sums_of_products<lanes>(values_.get() + block * columns_ * lanes, coefficients.data(),
                                            static_cast<Eigen::Index>(columns_));
  const std::size_t count = std::min(lanes, vertices_.size() - block * lanes);
  for (std::size_t lane = 0; lane < count; ++lane) {
    const auto at = static_cast<Eigen::Index>(lane);
    positions.row(vertices_[block * lanes + lane]) +=
        scale * Eigen::RowVector3d(sums[0][at], sums[1][at], sums[2][at]);
  }
}

std::int64_t ResponseColumns::memory_bytes() const {
  return static_cast<std::int64_t>(value_count() * sizeof(float) + vertices_.size() * sizeof(Index));
}

}  // namespace meshgraft
