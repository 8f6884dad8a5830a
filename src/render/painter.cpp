#include "painter.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "seen_triangle.h"
#include "visible_triangles.h"

namespace meshgraft::render {

namespace {

// Colours: warm clay on light grey.
const Vec3 wire(0.05f, 0.05f, 0.06f);
const Vec3 key_light(2.05f, 1.93f, 1.75f);
const Vec3 fill_light(0.34f, 0.40f, 0.50f);
const Vec3 sky_light(0.86f, 0.90f, 0.97f);
const Vec3 ground_light(0.50f, 0.46f, 0.42f);

float square(float x) { return x * x; }

/// Returns light grey, a little darker towards the edges of the picture.
Vec3 backdrop(float x, float y) {
  return Vec3(0.885f, 0.89f, 0.90f) * (1.0f - 0.22f * (square(x - 0.5f) + square(y - 0.45f)));
}

}  // namespace

Appearance Painter::at(float x, float y, std::uint32_t triangle) const {
  const Eigen::Vector3d towards = view_.direction_to(x, y);
  return triangle == no_triangle ? beyond(x, y, towards) : surface(towards, triangle);
}

Appearance Painter::beyond(float x, float y, const Eigen::Vector3d& towards) const {
  const Vec3 direction = towards.cast<float>().normalized();
  Appearance out;
  out.point = 100.0f * direction;
  if (options_.transparent) return out;
  out.plain = backdrop(x / view_.width, y / view_.height);
  const float sinking = direction.dot(view_.zenith);
  if (!options_.ground || sinking >= -1e-4f) return out;
  const Vec3 point = view_.ground / sinking * direction;
  const float distance2 = (point - view_.middle).squaredNorm();
  if (distance2 > 36.0f) return out;
  // The ground shows only its shadow, which fades out with the distance.
  const float fade = std::exp(-0.12f * std::max(0.0f, distance2 - 1.0f));
  out.by_open = 0.58f * fade * out.plain;
  out.by_key = 0.20f * fade * out.plain;
  out.plain *= 1.0f - 0.78f * fade;
  out.normal = view_.zenith;
  out.point = point;
  return out;
}

Appearance Painter::surface(const Eigen::Vector3d& towards, std::uint32_t triangle) const {
  const auto corners = scene_.triangles.row(static_cast<Eigen::Index>(triangle));
  const auto point = [&](int c) -> const Vec3& { return points_[static_cast<std::size_t>(corners[c])]; };
  const SeenTriangle seen(point(0), point(1), point(2));
  const Vec3 weights = seen.weights(towards), direction = towards.cast<float>().normalized();
  Vec3 normal = Vec3::Zero(), colour = Vec3::Zero(), at = Vec3::Zero();
  for (int c = 0; c < 3; ++c) {
    at += weights[c] * point(c);
    normal += weights[c] * normals_.of(triangle)[static_cast<std::size_t>(c)];
    colour +=
        weights[c] * (scene_.colours.empty() ? clay : scene_.colours[static_cast<std::size_t>(corners[c])]);
  }
  const Vec3 area_vector = (point(1) - point(0)).cross(point(2) - point(0));
  Vec3 flat = area_vector.normalized();
  normal.normalize();
  if (flat.dot(direction) > 0.0f) {  // the inside of an open surface: a darker shade of the same
    flat = -flat;
    normal = -normal;
    colour *= 0.72f;
  }
  if (normal.dot(direction) > -0.02f)
    normal = (normal - (normal.dot(direction) + 0.02f) * direction).normalized();
  if (options_.wireframe) {
    const float pixel = view_.spacing_at(at) * std::abs(direction.z());
    colour += wire_coverage(triangle, weights, area_vector.norm() / pixel) * (wire - colour);
  }

  Appearance out;
  out.on_shape = true;
  out.normal = normal;
  out.point = at + lift_ * flat;
  const float up = 0.5f + 0.5f * normal.dot(view_.zenith);
  const Vec3 sky = 0.62f * (up * sky_light + (1.0f - up) * ground_light);
  const Vec3 fill = 0.42f * std::max(0.0f, normal.dot(view_.to_fill)) * fill_light;
  out.plain = colour.cwiseProduct(0.35f * fill);
  // Brightens the silhouette, where the surface turns away from the camera.
  const float grazing = square(square(1.0f - std::max(0.0f, -normal.dot(direction))));
  out.by_open = colour.cwiseProduct(sky + 0.65f * fill) + 0.10f * grazing * sky_light;
  const float key = std::max(0.0f, normal.dot(view_.to_key));
  if (key > 0.0f) {
    // Diffuse, and a faint broad highlight: fired clay.
    const Vec3 half = (view_.to_key - direction).normalized();
    const float shine4 = square(square(std::max(0.0f, normal.dot(half)))),
                shine28 = shine4 * square(shine4 * square(shine4));
    out.by_key = (key * 0.39f) * colour.cwiseProduct(key_light) + 0.07f * shine28 * key_light;
  }
  return out;
}

float Painter::wire_coverage(std::uint32_t triangle, const Vec3& weights, float area2) const {
  const auto corners = scene_.triangles.row(static_cast<Eigen::Index>(triangle));
  float cover = 0.0f;
  for (int c = 0; c < 3; ++c) {
    if (!(scene_.outlines[triangle] >> c & 1)) continue;
    const Vec3& a = points_[static_cast<std::size_t>(corners[(c + 1) % 3])];
    const Vec3& b = points_[static_cast<std::size_t>(corners[(c + 2) % 3])];
    const float pixels_away = weights[c] * area2 / std::max((a - b).norm(), 1e-12f);
    cover = std::max(cover, std::clamp(1.1f - pixels_away / 0.75f, 0.0f, 1.0f));
  }
  return 0.55f * cover;
}

}  // namespace meshgraft::render
