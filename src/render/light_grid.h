#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include <meshgraft/core/context.h>

#include "appearance.h"
#include "light_rays.h"
#include "view.h"

namespace meshgraft::render {

/// The light at the middle of every second pixel in both directions. Few rays measure it, and an edge-avoiding
/// wavelet filter smooths it (Dammertz et al. 2010). It has one array for each number that the filter uses,
/// namely both shares of light, and the normal and point of the surface. Rows are padded, so that loops along a
/// row need no tests for the ends of it.
class LightGrid {
 public:
  /// `looks` has the appearance at the middle of each pixel.
  LightGrid(const std::vector<Appearance>& looks, const View& view);

  /// Measures the light: this many rays from each point of the grid.
  void trace(const std::vector<Appearance>& looks, const LightRays& rays, int to_sky, int to_key,
             const Context& context);

  void smooth(const Context& context);

  /// Returns the light at a place of the picture, from those points around it that lie in one plane with the
  /// sample; nothing if there is none.
  std::optional<Light> at(float x, float y, const Appearance& sample) const;

 private:
  static constexpr std::size_t lane_count = 4;            // points that are computed at once
  static constexpr std::size_t padding = 8 + lane_count;  // the last pass reaches 8 points far
  static constexpr int spacing = 2;                       // in pixels

  /// Sums over the neighbours of a row's points.
  struct Sums {
    std::vector<float> weights, open, key;
  };

  std::size_t slot(int column, int row) const {
    return static_cast<std::size_t>(row) * stride_ + padding + static_cast<std::size_t>(column);
  }
  const Appearance& look_at(const std::vector<Appearance>& looks, int column, int row) const;
  /// Runs body(column, row) for all points.
  template <typename Body>
  void for_each_point(const Context& context, Body body) const;
  /// Averages neighbours `step` points apart that have similar shares and lie in one plane: a row of one pass.
  void smooth_row(int row, int step);
  /// Adds the neighbours of a row's points that are all equally far away. Both rows are given by their first
  /// slots.
  void add_neighbours(std::size_t here, std::size_t there, float distance2, int step, Sums& sums) const;

  const View& view_;
  int picture_width_, columns_, rows_;
  std::size_t stride_;
  std::array<std::vector<float>, 3> normal_, point_;
  std::vector<float> open_, key_, plane_;  // plane_: over a distance from the plane, gives the root of a cost
  std::vector<float> next_open_, next_key_;
};

}  // namespace meshgraft::render
