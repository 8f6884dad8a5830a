#include "light_rays.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

#include "random.h"

namespace meshgraft::render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;
constexpr float key_softness = 0.16f;  // tangent of the key light's half angle
constexpr float reach_from_shape = 1.2f, reach_from_ground = 3.0f;
constexpr float cell_in_pixels = 3.0f, largest_cell = 0.01f;

struct Basis {
  Vec3 u, v, w;
  explicit Basis(const Vec3& direction) : w(direction.normalized()) {
    u = (std::abs(w.x()) < 0.7f ? Vec3::UnitX() : Vec3::UnitY()).cross(w).normalized();
    v = w.cross(u);
  }

  /// Returns the direction at this height along w, turned about w by a share of a full turn.
  Vec3 direction(float radius, float turn, float height) const {
    return radius * std::cos(2.0f * pi * turn) * u + radius * std::sin(2.0f * pi * turn) * v + height * w;
  }
};

}  // namespace

LightRays::LightRays(const std::vector<Vec3>& points, const Triangles& triangles, const View& view,
                     const Context& context)
    : LightRays(make_occluders(points, triangles,
                               std::min(cell_in_pixels * view.spacing_at(view.middle), largest_cell), context),
                view, context) {}

LightRays::LightRays(const Occluders& occluders, const View& view, const Context& context)
    : view_(view), tracer_(occluders.triangles, context), lift_(occluders.lift) {}

Light LightRays::light_at(const Appearance& sample, const RaySet& rays) const {
  Light light;
  if (!sample.needs_light()) return light;
  constexpr std::uint32_t no_sample = ~std::uint32_t{0};  // other numbers than those of samples
  Random random(rays.set, no_sample);
  const float shift = random.next(), turn = random.next(), key_shift = random.next(), key_turn = random.next();
  const auto part = [](float start, float rate, std::uint32_t k) {
    const float value = start + rate * static_cast<float>(k);
    return value - std::floor(value);
  };
  // Directions to the sky are weighted by their cosine.
  const Basis sky(sample.normal), key(view_.to_key);
  const float reach = sample.on_shape ? reach_from_shape : reach_from_ground;
  for (int ray = 0; ray < rays.to_sky; ++ray) {
    const std::uint32_t k =
        rays.number * static_cast<std::uint32_t>(rays.to_sky) + static_cast<std::uint32_t>(ray);
    const float height2 = part(shift, 0.7548777f, k);
    const Vec3 direction =
        sky.direction(std::sqrt(1.0f - height2), part(turn, 0.5698403f, k), std::sqrt(height2));
    if (!tracer_.blocked(sample.point, direction, reach)) light.open += 1.0f / static_cast<float>(rays.to_sky);
  }
  if (sample.normal.dot(view_.to_key) <= 0.0f) return light;
  for (int ray = 0; ray < rays.to_key; ++ray) {
    const std::uint32_t k =
        rays.number * static_cast<std::uint32_t>(rays.to_key) + static_cast<std::uint32_t>(ray);
    const float radius = key_softness * std::sqrt(part(key_shift, 0.7548777f, k));
    const Vec3 direction = key.direction(radius, part(key_turn, 0.5698403f, k), 1.0f).normalized();
    if (!tracer_.blocked(sample.point, direction)) light.key += 1.0f / static_cast<float>(rays.to_key);
  }
  return light;
}

}  // namespace meshgraft::render
