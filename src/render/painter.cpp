#include "painter.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include <Eigen/Geometry>

#include "core/parallel.h"

namespace meshgraft::render {

namespace {

constexpr float pi = std::numbers::pi_v<float>;

// Colours: warm clay on light grey.
const Vec3 clay(0.50f, 0.395f, 0.32f);
const Vec3 wire(0.05f, 0.05f, 0.06f);
const Vec3 key_light(2.05f, 1.93f, 1.75f);
const Vec3 fill_light(0.34f, 0.40f, 0.50f);
const Vec3 sky_light(0.86f, 0.90f, 0.97f);
const Vec3 ground_light(0.50f, 0.46f, 0.42f);
constexpr float key_softness = 0.16f;  // tangent of the key light's half angle

/// Deterministic random numbers: a hash of pixel, sample and counter.
class Random {
 public:
  Random(std::uint32_t pixel, std::uint32_t sample) : state_((std::uint64_t{pixel} << 20) ^ sample) {}
  float next() {
    state_ += 0x9E3779B97F4A7C15ull;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ull;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBull;
    return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1.0p-24f;
  }

 private:
  std::uint64_t state_;
};

struct Basis {
  Vec3 u, v, w;
  explicit Basis(const Vec3& direction) : w(direction.normalized()) {
    u = (std::abs(w.x()) < 0.7f ? Vec3::UnitX() : Vec3::UnitY()).cross(w).normalized();
    v = w.cross(u);
  }
};

/// Returns the triangles of all surfaces, one surface after another, in the view's coordinates.
std::vector<RayTriangle> all_triangles(std::span<const Surface> surfaces, const View& view,
                                       const Context& context) {
  std::size_t count = 0;
  for (const Surface& surface : surfaces) count += static_cast<std::size_t>(surface.triangles.rows());
  std::vector<RayTriangle> out(count);
  std::size_t first = 0;
  for (const Surface& surface : surfaces) {
    parallel_blocks(
        static_cast<std::size_t>(surface.triangles.rows()),
        [&](std::size_t begin, std::size_t end) {
          for (std::size_t t = begin; t < end; ++t)
            for (int c = 0; c < 3; ++c) {
              const Index v = surface.triangles(static_cast<Eigen::Index>(t), c);
              out[first + t][static_cast<std::size_t>(c)] =
                  ((surface.positions.row(v).transpose() - view.centre) / view.scale).cast<float>();
            }
        },
        context, 4096);
    first += static_cast<std::size_t>(surface.triangles.rows());
  }
  return out;
}

}  // namespace

Painter::Painter(std::span<const Surface> surfaces, const View& view, const RenderOptions& options,
                 const Context& context)
    : surfaces_(surfaces),
      view_(view),
      options_(options),
      triangles_(all_triangles(surfaces, view, context)),
      tracer_(triangles_, context) {
  std::uint32_t first = 0;
  for (const Surface& surface : surfaces) {
    first_triangles_.push_back(first);
    first += static_cast<std::uint32_t>(surface.triangles.rows());
  }
  grid_ = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(options.samples) + 1e-9)));
  occlusion_rays_ = std::max(1, options.occlusion_rays / (grid_ * grid_));
}

Pixel Painter::middle_of_pixel(int x, int y) const {
  constexpr int side = 4, rays = 2;
  const int columns = (options_.width + side - 1) / side;
  Random shared(static_cast<std::uint32_t>(y / side * columns + x / side), ~1u);
  const int k = y % side * side + x % side;
  const float shift = shared.next(), turn = shared.next();
  const auto stratum = [k](float offset, float rate) {
    const float value = offset + 0.5f + rate * static_cast<float>(k);
    return value - std::floor(value);
  };
  const Offsets to_light{stratum(shift, 0.7548777f), stratum(turn, 0.5698403f)};
  return ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, {rays * k, rays, shift, turn},
             to_light);
}

Pixel Painter::pixel(int x, int y) const {
  Pixel sum;
  const auto number = static_cast<std::uint32_t>(y * options_.width + x);
  Random shared(number, ~0u);
  const float turn = shared.next(), shift = shared.next();
  const int samples = grid_ * grid_;
  for (int s = 0; s < samples; ++s) {
    Random random(number, static_cast<std::uint32_t>(s));
    const int column = s % grid_, row = s / grid_;
    const float dx = (static_cast<float>(column) + random.next()) / static_cast<float>(grid_);
    const float dy = (static_cast<float>(row) + random.next()) / static_cast<float>(grid_);
    const Strata strata{s * occlusion_rays_, occlusion_rays_, shift, turn};
    const float u = random.next(), v = random.next();
    sum += ray(static_cast<float>(x) + dx, static_cast<float>(y) + dy, strata, {u, v});
  }
  sum *= 1.0f / static_cast<float>(samples);
  return sum;
}

Pixel Painter::ray(float x, float y, const Strata& strata, const Offsets& to_light) const {
  const auto width = static_cast<float>(options_.width), height = static_cast<float>(options_.height);
  const Vec3 direction = (view_.ahead + view_.tangent * ((2.0f * x - width) / height * view_.right +
                                                         (1.0f - 2.0f * y / height) * view_.up))
                             .normalized();
  if (const auto hit = tracer_.first_hit(view_.eye, direction))
    return surface(*hit, direction, strata, to_light);
  Pixel out;
  out.point = view_.eye + 100.0f * direction;
  if (options_.transparent) return out;
  out.plain = backdrop(x / width, y / height);
  const float sinking = direction.dot(view_.zenith);
  if (!options_.ground || sinking >= -1e-4f) return out;
  const Vec3 point = view_.eye + (view_.ground - view_.eye.dot(view_.zenith)) / sinking * direction;
  const float distance2 = point.squaredNorm();
  if (distance2 > 36.0f) return out;
  // The ground shows only its shadow, which fades out with the distance.
  const float fade = std::exp(-0.12f * std::max(0.0f, distance2 - 1.0f));
  out.by_open = 0.58f * fade * out.plain;
  out.by_key = 0.20f * fade * out.plain;
  out.plain *= 1.0f - 0.78f * fade;
  out.open = openness(point, view_.zenith, 3.0f, strata);
  out.key = key_visible(point, to_light) ? 1.0f : 0.0f;
  out.normal = view_.zenith;
  out.point = point;
  return out;
}

Vec3 Painter::backdrop(float x, float y) {
  const float r2 = (x - 0.5f) * (x - 0.5f) + (y - 0.45f) * (y - 0.45f);
  return Vec3(0.885f, 0.89f, 0.90f) * (1.0f - 0.22f * r2);
}

bool Painter::key_visible(const Vec3& point, const Offsets& offsets) const {
  const Basis basis(view_.to_key);
  const float r = key_softness * std::sqrt(offsets.u), turn = 2.0f * pi * offsets.v;
  const Vec3 to_light = (basis.w + r * std::cos(turn) * basis.u + r * std::sin(turn) * basis.v).normalized();
  return !tracer_.blocked(point, to_light);
}

float Painter::openness(const Vec3& point, const Vec3& normal, float reach, const Strata& strata) const {
  const Basis basis(normal);
  int open = 0;
  for (int i = 0; i < strata.count; ++i) {
    const auto k = static_cast<float>(strata.first + i);
    float u = strata.shift + 0.7548777f * k, turn = strata.turn + 0.5698403f * k;
    u -= std::floor(u);
    turn = 2.0f * pi * (turn - std::floor(turn));
    const float r = std::sqrt(u);
    const Vec3 direction =
        r * std::cos(turn) * basis.u + r * std::sin(turn) * basis.v + std::sqrt(1.0f - u) * basis.w;
    if (!tracer_.blocked(point, direction, reach)) ++open;
  }
  return static_cast<float>(open) / static_cast<float>(strata.count);
}

Pixel Painter::surface(const RayTracer::Hit& hit, const Vec3& direction, const Strata& strata,
                       const Offsets& to_light) const {
  const auto after = std::upper_bound(first_triangles_.begin(), first_triangles_.end(), hit.triangle);
  const Surface& surface = surfaces_[static_cast<std::size_t>(after - first_triangles_.begin() - 1)];
  const std::size_t t = hit.triangle - *std::prev(after);
  const float weights[3] = {1.0f - hit.u - hit.v, hit.u, hit.v};
  const auto corners = surface.triangles.row(static_cast<Eigen::Index>(t));
  Vec3 normal = Vec3::Zero(), colour = Vec3::Zero();
  for (int c = 0; c < 3; ++c) {
    normal += weights[c] * surface.corner_normals[3 * t + static_cast<std::size_t>(c)];
    colour += weights[c] * (surface.colours.empty() ? clay : surface.colours[corners[c]]);
  }
  const auto& [p0, p1, p2] = triangles_[hit.triangle];
  const Vec3 area_vector = (p1 - p0).cross(p2 - p0);
  Vec3 flat = area_vector.normalized();
  normal.normalize();
  if (flat.dot(direction) > 0.0f) {  // the inside of an open surface: a darker shade of the same
    flat = -flat;
    normal = -normal;
    colour *= 0.72f;
  }
  if (normal.dot(direction) > -0.02f)
    normal = (normal - (normal.dot(direction) + 0.02f) * direction).normalized();
  const Vec3 point = view_.eye + hit.distance * direction + 2e-4f * flat;
  if (options_.wireframe) {
    const float depth = hit.distance * std::abs(direction.dot(view_.ahead));
    const float pixel = 2.0f * view_.tangent * depth / static_cast<float>(options_.height);
    colour += wire_coverage(surface, t, weights, area_vector.norm() / pixel) * (wire - colour);
  }

  Pixel out;
  out.cover = 1.0f;
  out.normal = normal;
  out.point = point;
  out.open = openness(point, normal, 1.2f, strata);
  const float up = 0.5f + 0.5f * normal.dot(view_.zenith);
  const Vec3 sky = 0.62f * (up * sky_light + (1.0f - up) * ground_light);
  const Vec3 fill = 0.42f * std::max(0.0f, normal.dot(view_.to_fill)) * fill_light;
  out.plain = colour.cwiseProduct(0.35f * fill);
  // Brightens the silhouette, where the surface turns away from the camera.
  const float grazing = std::pow(1.0f - std::max(0.0f, -normal.dot(direction)), 4.0f);
  out.by_open = colour.cwiseProduct(sky + 0.65f * fill) + 0.10f * grazing * sky_light;
  const float key = std::max(0.0f, normal.dot(view_.to_key));
  if (key > 0.0f) {
    out.key = key_visible(point, to_light) ? 1.0f : 0.0f;
    // Diffuse, and a faint broad highlight: fired clay.
    const Vec3 half = (view_.to_key - direction).normalized();
    out.by_key = (key * 0.39f) * colour.cwiseProduct(key_light) +
                 0.07f * std::pow(std::max(0.0f, normal.dot(half)), 28.0f) * key_light;
  }
  return out;
}

float Painter::wire_coverage(const Surface& surface, std::size_t t, const float* weights, float area2) const {
  float cover = 0.0f;
  for (int c = 0; c < 3; ++c) {
    if (!(surface.outlines[t] >> c & 1)) continue;
    const Index a = surface.triangles(static_cast<Eigen::Index>(t), (c + 1) % 3);
    const Index b = surface.triangles(static_cast<Eigen::Index>(t), (c + 2) % 3);
    const double edge = (surface.positions.row(a) - surface.positions.row(b)).norm() / view_.scale;
    const float pixels_away = weights[c] * static_cast<float>(area2 / std::max(edge, 1e-12));
    cover = std::max(cover, std::clamp(1.1f - pixels_away / 0.75f, 0.0f, 1.0f));
  }
  return 0.55f * cover;
}

}  // namespace meshgraft::render
