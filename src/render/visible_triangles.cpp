#include "visible_triangles.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel.h"
#include "seen_triangle.h"

namespace meshgraft::render {

namespace {

// A depth, and the triangle there. The nearest one is the smallest key, of equally near ones that with the
// smallest number; so the order of drawing does not matter.
using Key = std::uint64_t;
constexpr Key nothing = std::numeric_limits<Key>::max();

Key key_of(float depth, std::uint32_t triangle) {
  return Key{std::bit_cast<std::uint32_t>(depth)} << 32 | triangle;
}

void keep_smaller(Key& kept, Key key) {
  const std::atomic_ref<Key> shared(kept);
  Key known = shared.load(std::memory_order_relaxed);
  while (key < known && !shared.compare_exchange_weak(known, key, std::memory_order_relaxed)) {
  }
}

/// The pixels [begin, end) of a row or a column.
struct PixelRange {
  int begin, end;
};

// Returns the pixels that may have a sample between two places.
PixelRange pixels_between(double low, double high, const Samples& samples, int size) {
  constexpr double rounding = 1e-3;
  const bool middle = samples.in_the_middle();
  const double begin = middle ? std::ceil(low - 0.5 - rounding) : std::floor(low - rounding);
  const double end = std::floor(middle ? high - 0.5 + rounding : high + rounding) + 1;
  const auto within = [size](double pixel) {
    return static_cast<int>(std::clamp(pixel, 0.0, static_cast<double>(size)));
  };
  return {within(begin), within(end)};
}

/// The part of a triangle ahead of the eye in the picture: a convex polygon of places in pixels.
class Outline {
 public:
  Outline(const std::array<Vec3, 3>& corners, const View& view) {
    for (std::size_t c = 0; c < 3; ++c) {
      const Eigen::Vector3d from = corners[c].cast<double>(), to = corners[(c + 1) % 3].cast<double>();
      if (is_ahead(from)) add(from, view);
      if (is_ahead(from) != is_ahead(to))
        add(from + (-nearest - from.z()) / (to.z() - from.z()) * (to - from), view);
    }
  }

  PixelRange rows(const Samples& samples) const {
    double low = infinite, high = -infinite;
    for (std::size_t k = 0; k < count_; ++k) {
      low = std::min(low, places_[k].y());
      high = std::max(high, places_[k].y());
    }
    if (count_ == 0) return {0, 0};
    const PixelRange rows = pixels_between(low, high, samples, samples.height());
    return {std::max(rows.begin, samples.first_row()), std::min(rows.end, samples.end_row())};
  }

  /// Returns the pixels of a row that may have a sample in the polygon.
  PixelRange columns(int row, const Samples& samples) const {
    constexpr double rounding = 1e-3;
    const double top = samples.in_the_middle() ? row + 0.5 - rounding : row - rounding;
    const double bottom = samples.in_the_middle() ? row + 0.5 + rounding : row + 1 + rounding;
    double low = infinite, high = -infinite;
    for (std::size_t k = 0; k < count_; ++k) {
      // The part of an edge between the top and the bottom of the row.
      Eigen::Vector2d from = places_[k], to = places_[k + 1 == count_ ? 0 : k + 1];
      if (from.y() > to.y()) std::swap(from, to);
      if (to.y() < top || from.y() > bottom) continue;
      const auto x_at = [&](double y) {
        return from.x() + (y - from.y()) / (to.y() - from.y()) * (to.x() - from.x());
      };
      for (const double x : {from.y() < top ? x_at(top) : from.x(), to.y() > bottom ? x_at(bottom) : to.x()}) {
        low = std::min(low, x);
        high = std::max(high, x);
      }
    }
    if (low > high) return {0, 0};
    return pixels_between(low, high, samples, samples.width());
  }

 private:
  static constexpr double nearest = 1e-6, infinite = std::numeric_limits<double>::infinity();

  static bool is_ahead(const Eigen::Vector3d& point) { return point.z() < -nearest; }

  void add(const Eigen::Vector3d& point, const View& view) { places_[count_++] = view.place_of(point); }

  std::array<Eigen::Vector2d, 4> places_;
  std::size_t count_ = 0;
};

}  // namespace

std::vector<std::uint32_t> visible_triangles(const std::vector<Vec3>& points, const Triangles& triangles,
                                             const View& view, const Samples& samples, const Context& context) {
  std::vector<Key> keys(samples.size(), nothing);
  const auto draw = [&](std::uint32_t number) {
    std::array<Vec3, 3> corners;
    for (int c = 0; c < 3; ++c)
      corners[static_cast<std::size_t>(c)] =
          points[static_cast<std::size_t>(triangles(static_cast<Eigen::Index>(number), c))];
    const Outline outline(corners, view);
    const PixelRange rows = outline.rows(samples);
    if (rows.begin >= rows.end) return;
    const SeenTriangle triangle(corners[0], corners[1], corners[2]);
    for (int y = rows.begin; y < rows.end; ++y) {
      const PixelRange columns = outline.columns(y, samples);
      for (int x = columns.begin; x < columns.end; ++x) {
        const std::size_t first = samples.first(samples.pixel(x, y));
        if (first == Samples::none) continue;
        for (std::size_t s = 0; s < samples.per_pixel(); ++s) {
          const Eigen::Vector2f place = samples.place(x, y, s);
          const Eigen::Vector3d direction = view.direction_to(place.x(), place.y());
          if (!triangle.is_met(direction)) continue;
          const auto depth = static_cast<float>(triangle.depth(direction));
          if (depth > 0.0f) keep_smaller(keys[first + s], key_of(depth, number));
        }
      }
    }
  };
  parallel_blocks(
      static_cast<std::size_t>(triangles.rows()),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) draw(static_cast<std::uint32_t>(t));
      },
      context, 64);
  std::vector<std::uint32_t> seen(keys.size());
  std::ranges::transform(keys, seen.begin(), [](Key key) {
    return key == nothing ? no_triangle : static_cast<std::uint32_t>(key);
  });
  return seen;
}

}  // namespace meshgraft::render
