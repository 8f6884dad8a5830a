#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>

#include "mesh/ray_tracer.h"
#include "pixel.h"
#include "view.h"

namespace meshgraft::render {

/// Traces the rays of a picture: what a pixel shows, and the light on it.
class Painter {
 public:
  Painter(std::span<const Surface> surfaces, const View& view, const RenderOptions& options,
          const Context& context);

  /// Returns a pixel by one camera ray through its middle. Its few rays for light are strata of a square of
  /// pixels.
  Pixel middle_of_pixel(int x, int y) const;

  Pixel pixel(int x, int y) const;

 private:
  /// Two numbers from 0 to 1 that choose a direction to the light.
  struct Offsets {
    float u, v;
  };

  /// Offsets of a sample's rays in the low-discrepancy sequence of the pixel, or of a square of pixels.
  struct Strata {
    int first, count;
    float shift, turn;
  };

  Pixel ray(float x, float y, const Strata& strata, const Offsets& to_light) const;

  /// Light grey, a little darker towards the edges of the picture.
  static Vec3 backdrop(float x, float y);

  bool key_visible(const Vec3& point, const Offsets& offsets) const;

  /// Returns the cosine-weighted share of directions that are free up to `reach`. The pixel's rays follow the
  /// plastic sequence (Roberts 2018), shifted by a hash of the pixel. The rays are even over the hemisphere
  /// and differ between pixels.
  float openness(const Vec3& point, const Vec3& normal, float reach, const Strata& strata) const;

  Pixel surface(const RayTracer::Hit& hit, const Vec3& direction, const Strata& strata,
                const Offsets& to_light) const;

  /// Returns how much of a point a thin line along its triangle's edges covers; the line is about one pixel
  /// wide. The last argument is twice the triangle's area over the size of a pixel.
  float wire_coverage(const Surface& surface, std::size_t t, const float* weights, float area2) const;

  std::span<const Surface> surfaces_;
  const View& view_;
  const RenderOptions& options_;
  std::vector<RayTriangle> triangles_;
  std::vector<std::uint32_t> first_triangles_;  // by surface
  RayTracer tracer_;
  int grid_ = 1;
  int occlusion_rays_ = 1;
};

}  // namespace meshgraft::render
