#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <Eigen/Core>

#include <meshgraft/mesh/mesh.h>

#include "random.h"

namespace meshgraft::render {

/// The samples of a picture: one in the middle of each pixel, or side×side in some pixels, each at random in
/// its cell of a grid. They are numbered pixel by pixel.
class Samples {
 public:
  /// One sample per pixel.
  Samples(int width, int height) : width_(width), height_(height), end_row_(height) {}

  /// Samples in the chosen pixels.
  Samples(int width, int height, int side, const Flags& chosen)
      : width_(width), height_(height), side_(side), first_row_(height), end_row_(0) {
    first_.assign(chosen.size(), none);
    for (std::size_t pixel = 0; pixel < chosen.size(); ++pixel) {
      if (!chosen[pixel]) continue;
      first_[pixel] = chosen_count_ * per_pixel();
      ++chosen_count_;
      const auto row = static_cast<int>(pixel / static_cast<std::size_t>(width));
      first_row_ = std::min(first_row_, row);
      end_row_ = std::max(end_row_, row + 1);
    }
  }

  int width() const { return width_; }
  int height() const { return height_; }
  // All samples are in these rows.
  int first_row() const { return first_row_; }
  int end_row() const { return end_row_; }
  bool in_the_middle() const { return first_.empty(); }
  std::size_t per_pixel() const { return static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_); }
  std::size_t size() const {
    return in_the_middle() ? static_cast<std::size_t>(width_) * static_cast<std::size_t>(height_)
                           : chosen_count_ * per_pixel();
  }

  std::size_t pixel(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
  }

  /// Returns the number of a pixel's first sample, or `none`.
  std::size_t first(std::size_t pixel) const { return in_the_middle() ? pixel : first_[pixel]; }
  static constexpr std::size_t none = std::numeric_limits<std::size_t>::max();

  /// Returns the place of a sample of pixel (x, y) in the picture, in pixels.
  Eigen::Vector2f place(int x, int y, std::size_t sample) const {
    return place(pixel(x, y), sample) + Eigen::Vector2f(static_cast<float>(x), static_cast<float>(y));
  }

  /// Returns the place of a pixel's sample in the pixel, from (0, 0) to (1, 1).
  Eigen::Vector2f place(std::size_t pixel, std::size_t sample) const {
    if (in_the_middle()) return {0.5f, 0.5f};
    const auto side = static_cast<std::size_t>(side_);
    Random random(static_cast<std::uint32_t>(pixel), static_cast<std::uint32_t>(sample));
    const float x = static_cast<float>(sample % side) + random.next();
    const float y = static_cast<float>(sample / side) + random.next();
    return Eigen::Vector2f(x, y) / static_cast<float>(side_);
  }

 private:
  int width_, height_, side_ = 1, first_row_ = 0, end_row_;
  std::size_t chosen_count_ = 0;
  std::vector<std::size_t> first_;  // by pixel; empty if all have one in their middle
};

}  // namespace meshgraft::render
