#include "light_filter.h"

#include <cstring>
#include <utility>

#include "core/parallel.h"

namespace meshgraft::render {

namespace {

using Lanes [[gnu::vector_size(4 * sizeof(float))]] = float;

/// Returns exp(-cost) to three digits, and 0 for costs above 9.
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

LightFilter::LightFilter(const std::vector<Pixel>& pixels, const RenderOptions& options, const View& view)
    : options_(options), stride_(static_cast<std::size_t>(options.width) + 2 * padding) {
  const std::size_t size = stride_ * static_cast<std::size_t>(options.height);
  for (auto* values : {&normal_[0], &normal_[1], &normal_[2], &point_[0], &point_[1], &point_[2], &open_, &key_,
                       &plane_, &next_open_, &next_key_})
    values->assign(size, 0.0f);
  // Padding has another normal than any surface, so that it has no weight.
  normal_[0].assign(size, 1e3f);
  for (int y = 0; y < options.height; ++y)
    for (int x = 0; x < options.width; ++x) {
      const std::size_t at = slot(x, y);
      const Pixel& pixel = pixels[static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) +
                                  static_cast<std::size_t>(x)];
      for (std::size_t k = 0; k < 3; ++k) {
        normal_[k][at] = pixel.normal[static_cast<Eigen::Index>(k)];
        point_[k][at] = pixel.point[static_cast<Eigen::Index>(k)];
      }
      open_[at] = pixel.open;
      key_[at] = pixel.key;
      plane_[at] = 1.0f / (3.0f * spacing_at(pixel.point, view, options));
    }
}

void LightFilter::run(const Context& context) {
  for (const int step : {1, 2, 4}) {
    parallel_blocks(
        static_cast<std::size_t>(options_.height),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t y = begin; y < end; ++y) smooth_row(static_cast<int>(y), step);
        },
        context, 8);
    std::swap(open_, next_open_);
    std::swap(key_, next_key_);
  }
}

void LightFilter::smooth_row(int y, int step) {
  const auto width = static_cast<std::size_t>(options_.width);
  const std::vector<float> none(width + lane_count, 0.0f);
  Sums sums{none, none, none};
  for (int dy = -2; dy <= 2; ++dy) {
    if (y + step * dy < 0 || y + step * dy >= options_.height) continue;
    for (int dx = -2; dx <= 2; ++dx)
      add_neighbours(slot(0, y), slot(step * dx, y + step * dy), static_cast<float>(dx * dx + dy * dy), step,
                     sums);
  }
  for (std::size_t x = 0; x < width; ++x) {
    const std::size_t at = slot(static_cast<int>(x), y);
    const bool is_surface = normal_[0][at] != 0.0f || normal_[1][at] != 0.0f || normal_[2][at] != 0.0f;
    next_open_[at] = is_surface ? sums.open[x] / sums.weights[x] : open_[at];
    next_key_[at] = is_surface ? sums.key[x] / sums.weights[x] : key_[at];
  }
}

void LightFilter::add_neighbours(std::size_t here, std::size_t there, float distance2, int step,
                                 Sums& sums) const {
  // Later passes reach further and must respect the differences that earlier passes have established.
  const float open_rate = step > 1 ? 1.0f / (0.16f * 0.16f) : 0.0f, key_rate = step > 1 ? 4.0f : 0.0f;
  const float plane_rate = 1.0f / static_cast<float>(step);
  for (std::size_t x = 0; x < static_cast<std::size_t>(options_.width); x += lane_count) {
    const auto at = [x](const std::vector<float>& values, std::size_t first) {
      return load(&values[first + x]);
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
    const Lanes weight = weight_of(0.35f * distance2 + 25.0f * turned + off_plane * off_plane +
                                   open_rate * open * open + key_rate * key * key);
    add(&sums.weights[x], weight);
    add(&sums.open[x], weight * there_open);
    add(&sums.key[x], weight * there_key);
  }
}

}  // namespace meshgraft::render
