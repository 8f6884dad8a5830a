#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <meshgraft/core/context.h>

#include "pixel.h"
#include "view.h"

namespace meshgraft::render {

/// Smooths the two shares of light of pixels, where few rays have measured them: an edge-avoiding wavelet
/// filter (Dammertz et al. 2010). It has one array for each number of a pixel that it uses, namely both shares,
/// and the normal and point of the surface. Rows are padded, so that loops along a row need no tests for the
/// ends of it.
class LightFilter {
 public:
  LightFilter(const std::vector<Pixel>& pixels, const RenderOptions& options, const View& view);

  /// Runs the three passes, whose neighbours are 1, 2 and 4 pixels apart.
  void run(const Context& context);

  float open(int x, int y) const { return open_[slot(x, y)]; }
  float key(int x, int y) const { return key_[slot(x, y)]; }

 private:
  static constexpr std::size_t lane_count = 4;            // pixels that are computed at once
  static constexpr std::size_t padding = 8 + lane_count;  // the last pass reaches 8 pixels far

  /// Sums over the neighbours of a row's pixels.
  struct Sums {
    std::vector<float> weights, open, key;
  };

  std::size_t slot(int x, int y) const {
    return static_cast<std::size_t>(y) * stride_ + padding + static_cast<std::size_t>(x);
  }

  /// Averages neighbours `step` pixels apart that have similar shares and lie in one plane: a row of one pass.
  void smooth_row(int y, int step);
  /// Adds the neighbours of a row's pixels that are all equally far away. Both rows are given by their first
  /// slots.
  void add_neighbours(std::size_t here, std::size_t there, float distance2, int step, Sums& sums) const;

  const RenderOptions& options_;
  std::size_t stride_;
  std::array<std::vector<float>, 3> normal_, point_;
  std::vector<float> open_, key_, plane_;  // plane_: over a distance from the plane, gives the root of a cost
  std::vector<float> next_open_, next_key_;
};

}  // namespace meshgraft::render
