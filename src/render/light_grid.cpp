#include "light_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <utility>

#include "core/parallel.h"

namespace meshgraft::render {

namespace {

constexpr float turn_rate = 25.0f;       // cost of a difference between unit normals, squared
constexpr float plane_in_pixels = 3.0f;  // distance from the plane that costs 1

using Lanes [[gnu::vector_size(4 * sizeof(float))]] = float;

/// Returns exp(-cost) to three digits, and 0 for costs above 9 or NaN.
Lanes weight_of(Lanes cost) {
  constexpr float most = 9, weight_of_most = 1.3e-4f;
  const Lanes part = (cost < most ? cost : Lanes{} + most) * (1.0f / 64);
  Lanes weight = 1.0f - part + 0.5f * part * part;
  for (int k = 0; k < 6; ++k) weight *= weight;
  weight -= weight_of_most;
  return weight > 0.0f ? weight : Lanes{};
}

Lanes load(const float* values) {
  Lanes lanes;
  std::memcpy(&lanes, values, sizeof(lanes));
  return lanes;
}

void add(float* values, Lanes sum) {
  sum += load(values);
  std::memcpy(values, &sum, sizeof(sum));
}

}  // namespace

LightGrid::LightGrid(const std::vector<Appearance>& looks, const View& view)
    : view_(view),
      picture_width_(static_cast<int>(view.width)),
      columns_((picture_width_ + spacing - 1) / spacing),
      rows_((static_cast<int>(view.height) + spacing - 1) / spacing),
      stride_(static_cast<std::size_t>(columns_) + 2 * padding) {
  const std::size_t size = stride_ * static_cast<std::size_t>(rows_);
  for (auto* values : {&normal_[1], &normal_[2], &point_[0], &point_[1], &point_[2], &open_, &key_, &plane_,
                       &next_open_, &next_key_})
    values->assign(size, 0.0f);
  // Padding has another normal than any surface, so that it has no weight.
  normal_[0].assign(size, 1e3f);
  for (int row = 0; row < rows_; ++row)
    for (int column = 0; column < columns_; ++column) {
      const std::size_t at = slot(column, row);
      const Appearance& look = look_at(looks, column, row);
      for (std::size_t k = 0; k < 3; ++k) {
        normal_[k][at] = look.normal[static_cast<Eigen::Index>(k)];
        point_[k][at] = look.point[static_cast<Eigen::Index>(k)];
      }
      plane_[at] = 1.0f / (plane_in_pixels * view.spacing_at(look.point));
    }
}

const Appearance& LightGrid::look_at(const std::vector<Appearance>& looks, int column, int row) const {
  return looks[static_cast<std::size_t>(spacing * row) * static_cast<std::size_t>(picture_width_) +
               static_cast<std::size_t>(spacing * column)];
}

template <typename Body>
void LightGrid::for_each_point(const Context& context, Body body) const {
  parallel_blocks(
      static_cast<std::size_t>(rows_),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row)
          for (int column = 0; column < columns_; ++column) body(column, static_cast<int>(row));
      },
      context, 4);
}

void LightGrid::trace(const std::vector<Appearance>& looks, const LightRays& rays, int to_sky, int to_key,
                      const Context& context) {
  // The points of a square share a set of rays if these are few.
  constexpr int enough = 16;
  const int side = to_sky < enough ? 4 : 1, squares = (columns_ + side - 1) / side;
  for_each_point(context, [&](int column, int row) {
    const auto set = static_cast<std::uint32_t>(row / side * squares + column / side);
    const auto number = static_cast<std::uint32_t>(row % side * side + column % side);
    const Light light = rays.light_at(look_at(looks, column, row), {set, number, to_sky, to_key});
    open_[slot(column, row)] = light.open;
    key_[slot(column, row)] = light.key;
  });
}

void LightGrid::smooth(const Context& context) {
  for (const int step : {1, 2, 4}) {
    parallel_blocks(
        static_cast<std::size_t>(rows_),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t row = begin; row < end; ++row) smooth_row(static_cast<int>(row), step);
        },
        context, 8);
    std::swap(open_, next_open_);
    std::swap(key_, next_key_);
  }
}

void LightGrid::smooth_row(int row, int step) {
  const auto count = static_cast<std::size_t>(columns_);
  const std::vector<float> none(count + lane_count, 0.0f);
  Sums sums{none, none, none};
  for (int dy = -2; dy <= 2; ++dy) {
    if (row + step * dy < 0 || row + step * dy >= rows_) continue;
    for (int dx = -2; dx <= 2; ++dx)
      add_neighbours(slot(0, row), slot(step * dx, row + step * dy), static_cast<float>(dx * dx + dy * dy),
                     step, sums);
  }
  for (std::size_t column = 0; column < count; ++column) {
    const std::size_t at = slot(static_cast<int>(column), row);
    const bool is_surface = normal_[0][at] != 0.0f || normal_[1][at] != 0.0f || normal_[2][at] != 0.0f;
    next_open_[at] = is_surface ? sums.open[column] / sums.weights[column] : open_[at];
    next_key_[at] = is_surface ? sums.key[column] / sums.weights[column] : key_[at];
  }
}

void LightGrid::add_neighbours(std::size_t here, std::size_t there, float distance2, int step,
                               Sums& sums) const {
  // Later passes reach further and must respect the differences that earlier passes have established.
  const float open_rate = step > 1 ? 1.0f / (0.16f * 0.16f) : 0.0f, key_rate = step > 1 ? 4.0f : 0.0f;
  const float plane_rate = 1.0f / static_cast<float>(step * spacing);
  for (std::size_t column = 0; column < static_cast<std::size_t>(columns_); column += lane_count) {
    const auto at = [column](const std::vector<float>& values, std::size_t first) {
      return load(&values[first + column]);
    };
    Lanes turned{}, off_plane{};
    for (std::size_t k = 0; k < 3; ++k) {
      const Lanes normal = at(normal_[k], here), between = normal - at(normal_[k], there);
      turned += between * between;
      off_plane += normal * (at(point_[k], there) - at(point_[k], here));
    }
    off_plane *= plane_rate * at(plane_, here);
    const Lanes there_open = at(open_, there), there_key = at(key_, there);
    const Lanes open = at(open_, here) - there_open, key = at(key_, here) - there_key;
    const Lanes weight = weight_of(0.35f * distance2 + turn_rate * turned + off_plane * off_plane +
                                   open_rate * open * open + key_rate * key * key);
    add(&sums.weights[column], weight);
    add(&sums.open[column], weight * there_open);
    add(&sums.key[column], weight * there_key);
  }
}

std::optional<Light> LightGrid::at(float x, float y, const Appearance& sample) const {
  constexpr float least_weight = 0.02f;
  const float column = (x - 0.5f) / static_cast<float>(spacing), row = (y - 0.5f) / static_cast<float>(spacing);
  const float left = std::floor(column), top = std::floor(row);
  const float plane = 1.0f / (plane_in_pixels * view_.spacing_at(sample.point));
  Light sum;
  float weights = 0.0f;
  for (int dy = 0; dy < 2; ++dy)
    for (int dx = 0; dx < 2; ++dx) {
      const float share = (dx == 0 ? left + 1 - column : column - left) * (dy == 0 ? top + 1 - row : row - top);
      if (share == 0.0f) continue;
      const std::size_t at = slot(std::clamp(static_cast<int>(left) + dx, 0, columns_ - 1),
                                  std::clamp(static_cast<int>(top) + dy, 0, rows_ - 1));
      const Vec3 normal(normal_[0][at], normal_[1][at], normal_[2][at]);
      const Vec3 point(point_[0][at], point_[1][at], point_[2][at]);
      const float off_plane = plane * sample.normal.dot(point - sample.point);
      const float cost = turn_rate * (normal - sample.normal).squaredNorm() + off_plane * off_plane;
      const float weight = share / ((1.0f + cost) * (1.0f + cost));
      weights += weight;
      sum.open += weight * open_[at];
      sum.key += weight * key_[at];
    }
  if (weights < least_weight) return std::nullopt;
  return Light{sum.open / weights, sum.key / weights};
}

}  // namespace meshgraft::render
