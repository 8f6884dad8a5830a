#include "render/render.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <numbers>
#include <utility>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/mesh/topology.h>

#include "core/parallel.h"
#include "mesh/ray_tracer.h"
#include "render/facts.h"

namespace meshgraft::render {

namespace {

using Vec3 = Eigen::Vector3f;

constexpr float pi = std::numbers::pi_v<float>;
constexpr int tile_side = 16;

// Colours: warm clay on light grey.
const Vec3 clay(0.50f, 0.395f, 0.32f);
const Vec3 wire(0.05f, 0.05f, 0.06f);
const Vec3 key_light(2.05f, 1.93f, 1.75f);
const Vec3 fill_light(0.34f, 0.40f, 0.50f);
const Vec3 sky_light(0.86f, 0.90f, 0.97f);
const Vec3 ground_light(0.50f, 0.46f, 0.42f);
constexpr float key_softness = 0.16f;  // tangent of the key light's half angle

double from_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

float to_srgb(float value) {
  return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f;
}

// Deterministic random numbers: a hash of pixel, sample and counter.
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

// One shape, triangulated, with a normal per corner.
struct Surface {
  Points positions;
  Triangles triangles;
  std::vector<Vec3> corner_normals;
  std::vector<Vec3> colours;  // per vertex, or empty
  // Per triangle, bit c: the edge opposite corner c belongs to the face. Empty unless they are drawn.
  std::vector<std::uint8_t> outlines;
};

std::vector<Vec3> corner_normals(const Points& positions, const Triangles& triangles,
                                 const RenderOptions& options, const Context& context) {
  const auto count = static_cast<std::size_t>(triangles.rows());
  std::vector<Vec3> flat(count);  // unit normal times twice the area
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
          const auto row = triangles.row(static_cast<Eigen::Index>(t));
          const Eigen::RowVector3d p = positions.row(row[0]), q = positions.row(row[1]),
                                   r = positions.row(row[2]);
          flat[t] = (q - p).cross(r - p).transpose().cast<float>();
        }
      },
      context, 4096);
  std::vector<Vec3> out(3 * count);
  const float limit = static_cast<float>(std::cos(options.crease_angle_deg * std::numbers::pi / 180.0));
  const IndexLists around = vertex_triangles(static_cast<Index>(positions.rows()), triangles, context);
  parallel_blocks(
      count,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t)
          for (int c = 0; c < 3; ++c) {
            Vec3 sum = flat[t];
            if (options.smooth)
              for (const Index other : around[triangles(static_cast<Eigen::Index>(t), c)]) {
                const Vec3& n = flat[other];
                if (static_cast<std::size_t>(other) != t && n.dot(flat[t]) > limit * n.norm() * flat[t].norm())
                  sum += n;
              }
            out[3 * t + static_cast<std::size_t>(c)] = sum.normalized();
          }
      },
      context, 4096);
  return out;
}

// Marks the edges to draw; diagonals of polygons are not drawn.
std::vector<std::uint8_t> outlines(const Mesh& mesh, const Triangulation& triangulation) {
  std::vector<std::uint8_t> bits(triangulation.triangles.rows(), 0);
  for (std::size_t t = 0; t < bits.size(); ++t) {
    const auto face = mesh.faces[triangulation.face[t]];
    for (int c = 0; c < 3; ++c) {
      const Index a = triangulation.triangles(static_cast<Eigen::Index>(t), (c + 1) % 3);
      const Index b = triangulation.triangles(static_cast<Eigen::Index>(t), (c + 2) % 3);
      for (std::size_t k = 0; k < face.size(); ++k)
        if (face[k] == a && face[(k + 1) % face.size()] == b) bits[t] |= static_cast<std::uint8_t>(1 << c);
    }
  }
  return bits;
}

Surface prepare(const Shape& shape, const RenderOptions& options, const Context& context) {
  const Mesh& mesh = *shape.mesh;
  if (shape.colours.rows() > 0 && shape.colours.rows() != mesh.positions.rows())
    throw Error(
        facts::render::ColoursIncomplete{.colours = shape.colours.rows(), .vertices = mesh.vertex_count()});
  const Triangulation triangulation = triangulate(mesh);
  Surface surface;
  surface.positions = mesh.positions.rowwise() + shape.offset.transpose();
  surface.triangles = triangulation.triangles;
  surface.corner_normals = corner_normals(surface.positions, surface.triangles, options, context);
  if (options.wireframe) surface.outlines = outlines(mesh, triangulation);
  for (Eigen::Index v = 0; v < shape.colours.rows(); ++v)
    surface.colours.push_back(shape.colours.row(v).transpose().cast<float>());
  return surface;
}

// The camera and the lights. Coordinates are relative to the scene's centre in units of its radius, so that
// single precision suffices anywhere.
struct View {
  Eigen::Vector3d centre;
  double scale = 1.0;
  Vec3 eye, right, up, ahead;
  Vec3 zenith;  // away from the ground
  float tangent = 0.0f;
  float ground = 0.0f;  // height along the zenith
  Vec3 to_key, to_fill;
};

View fit_view(std::span<const Surface> surfaces, const RenderOptions& options) {
  const Camera& camera = options.camera;
  if (!(camera.from_direction.norm() > 0.0) || !(camera.up.cross(camera.from_direction).norm() > 0.0))
    throw Error(facts::render::CameraWithoutDirection{});
  Eigen::Vector3d low = camera.low, high = camera.high;
  const bool fit = (low.array() > high.array()).any();
  if (fit) {
    low.setConstant(std::numeric_limits<double>::infinity());
    high = -low;
    for (const Surface& surface : surfaces) {
      low = low.cwiseMin(surface.positions.colwise().minCoeff().transpose());
      high = high.cwiseMax(surface.positions.colwise().maxCoeff().transpose());
    }
  }
  View view;
  view.centre = 0.5 * (low + high);
  view.scale = std::max(0.5 * (high - low).stableNorm(), std::numeric_limits<double>::min());
  const Eigen::Vector3d back = camera.from_direction.normalized();
  const Eigen::Vector3d right = camera.up.cross(back).normalized();
  const Eigen::Vector3d up = back.cross(right);

  // Places the camera as near as possible with every point (or corner of the given box) visible, centred
  // between the extreme ones.
  std::vector<Eigen::Vector3d> points;
  if (fit) {
    for (const Surface& surface : surfaces)
      for (Eigen::Index v = 0; v < surface.positions.rows(); ++v)
        points.push_back((surface.positions.row(v).transpose() - view.centre) / view.scale);
  } else {
    for (int corner = 0; corner < 8; ++corner) {
      const Eigen::Vector3d p(corner & 1 ? low.x() : high.x(), corner & 2 ? low.y() : high.y(),
                              corner & 4 ? low.z() : high.z());
      points.push_back((p - view.centre) / view.scale);
    }
  }
  constexpr double margin = 1.10;
  const double tangent_y = std::tan(0.5 * camera.field_of_view_deg * std::numbers::pi / 180.0) / margin;
  const double tangent_x = tangent_y * options.width / options.height;
  // Along each axis the four frustum planes bound the camera: |q·axis − e| ≤ tangent·(distance − q·back).
  double r_max = -1e30, r_min = -1e30, u_max = -1e30, u_min = -1e30;
  for (const Eigen::Vector3d& q : points) {
    const double depth = q.dot(back);
    r_max = std::max(r_max, q.dot(right) + tangent_x * depth);
    r_min = std::max(r_min, -q.dot(right) + tangent_x * depth);
    u_max = std::max(u_max, q.dot(up) + tangent_y * depth);
    u_min = std::max(u_min, -q.dot(up) + tangent_y * depth);
  }
  const double distance = std::max((r_max + r_min) / (2.0 * tangent_x), (u_max + u_min) / (2.0 * tangent_y));
  const Eigen::Vector3d eye = 0.5 * (r_max - r_min) * right + 0.5 * (u_max - u_min) * up + distance * back;
  view.eye = eye.cast<float>();
  view.right = right.cast<float>();
  view.up = up.cast<float>();
  view.ahead = -back.cast<float>();
  view.tangent = static_cast<float>(tangent_y * margin);
  const Eigen::Vector3d zenith = camera.up.normalized();
  double lowest = std::numeric_limits<double>::infinity();
  for (const Eigen::Vector3d& q : points) lowest = std::min(lowest, q.dot(zenith));
  for (const Surface& surface : surfaces)  // also beyond the box that is shown
    lowest = std::min(
        lowest, ((surface.positions.rowwise() - view.centre.transpose()) * zenith).minCoeff() / view.scale);
  view.zenith = zenith.cast<float>();
  view.ground = static_cast<float>(lowest) - 1e-4f;
  view.to_key = (-0.55 * right + 0.85 * zenith + 0.62 * back).cast<float>().normalized();
  view.to_fill = (0.95 * right + 0.25 * zenith + 0.45 * back).cast<float>().normalized();
  return view;
}

// Returns the triangles of all surfaces, one surface after another, in the view's coordinates.
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

// A pixel's colour is plain + open·by_open + key·by_key. The two shares of light come from few random rays.
// They are stored separately, so that they can be smoothed over neighbouring pixels without blurring the
// picture.
struct Pixel {
  Vec3 plain = Vec3::Zero(), by_open = Vec3::Zero(), by_key = Vec3::Zero();
  Vec3 normal = Vec3::Zero(), point = Vec3::Zero();
  float open = 0.0f, key = 0.0f;
  float cover = 0.0f;  // 1 on the shapes

  Pixel& operator+=(const Pixel& other) {
    plain += other.plain;
    by_open += other.by_open;
    by_key += other.by_key;
    normal += other.normal;
    point += other.point;
    open += other.open;
    key += other.key;
    cover += other.cover;
    return *this;
  }
  Pixel& operator*=(float factor) {
    plain *= factor;
    by_open *= factor;
    by_key *= factor;
    normal *= factor;
    point *= factor;
    open *= factor;
    key *= factor;
    cover *= factor;
    return *this;
  }
};

class Painter {
 public:
  Painter(std::span<const Surface> surfaces, const View& view, const RenderOptions& options,
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

  // Returns a pixel by one camera ray through its middle. Its few rays for light are strata of a square of
  // pixels.
  Pixel middle_of_pixel(int x, int y) const {
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

  Pixel pixel(int x, int y) const {
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

 private:
  // Two numbers from 0 to 1 that choose a direction to the light.
  struct Offsets {
    float u, v;
  };

  // Offsets of a sample's rays in the low-discrepancy sequence of the pixel, or of a square of pixels.
  struct Strata {
    int first, count;
    float shift, turn;
  };

  Pixel ray(float x, float y, const Strata& strata, const Offsets& to_light) const {
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

  // Light grey, a little darker towards the edges of the picture.
  static Vec3 backdrop(float x, float y) {
    const float r2 = (x - 0.5f) * (x - 0.5f) + (y - 0.45f) * (y - 0.45f);
    return Vec3(0.885f, 0.89f, 0.90f) * (1.0f - 0.22f * r2);
  }

  bool key_visible(const Vec3& point, const Offsets& offsets) const {
    const Basis basis(view_.to_key);
    const float r = key_softness * std::sqrt(offsets.u), turn = 2.0f * pi * offsets.v;
    const Vec3 to_light = (basis.w + r * std::cos(turn) * basis.u + r * std::sin(turn) * basis.v).normalized();
    return !tracer_.blocked(point, to_light);
  }

  // Returns the cosine-weighted share of directions that are free up to `reach`. The pixel's rays follow the
  // plastic sequence (Roberts 2018), shifted by a hash of the pixel. The rays are even over the hemisphere
  // and differ between pixels.
  float openness(const Vec3& point, const Vec3& normal, float reach, const Strata& strata) const {
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

  Pixel surface(const RayTracer::Hit& hit, const Vec3& direction, const Strata& strata,
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

  // Returns how much of a point a thin line along its triangle's edges covers; the line is about one pixel
  // wide. The last argument is twice the triangle's area over the size of a pixel.
  float wire_coverage(const Surface& surface, std::size_t t, const float* weights, float area2) const {
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

  std::span<const Surface> surfaces_;
  const View& view_;
  const RenderOptions& options_;
  std::vector<RayTriangle> triangles_;
  std::vector<std::uint32_t> first_triangles_;  // by surface
  RayTracer tracer_;
  int grid_ = 1;
  int occlusion_rays_ = 1;
};

// Runs body(x, y) for all pixels, tile by tile.
template <typename Body>
void for_each_pixel(const RenderOptions& options, const Context& context, Body body) {
  const int columns = (options.width + tile_side - 1) / tile_side;
  const int rows = (options.height + tile_side - 1) / tile_side;
  parallel_blocks(
      static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows),
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t tile = begin; tile < end; ++tile) {
          const int x0 = static_cast<int>(tile) % columns * tile_side,
                    y0 = static_cast<int>(tile) / columns * tile_side;
          for (int y = y0; y < std::min(y0 + tile_side, options.height); ++y)
            for (int x = x0; x < std::min(x0 + tile_side, options.width); ++x) body(x, y);
        }
      },
      context, 1);
}

// Returns whether two neighbouring pixels show parts of one smooth surface in nearly the same colours.
bool belong_together(const Pixel& here, const Pixel& there, float spacing) {
  constexpr float least_cosine = 0.96f, most_colour = 0.06f;
  if (here.normal.isZero(0) != there.normal.isZero(0)) return false;
  if (here.normal.isZero(0)) return true;
  return here.normal.dot(there.normal) > least_cosine &&
         std::abs(here.normal.dot(there.point - here.point)) < spacing &&
         (here.point - there.point).squaredNorm() < 100 * spacing * spacing &&
         (here.plain - there.plain + 0.5f * (here.by_open - there.by_open)).cwiseAbs().maxCoeff() < most_colour;
}

// Returns the distance between two pixels on a surface that is seen from straight above.
float spacing_at(const Vec3& point, const View& view, const RenderOptions& options) {
  return 2.0f * view.tangent * (point - view.eye).norm() / static_cast<float>(options.height);
}

// Traces all pixels by one ray each, and again by all samples where a neighbour shows something else.
void trace_sparsely(const Painter& painter, const View& view, const RenderOptions& options,
                    std::vector<Pixel>& pixels, const Context& context) {
  const auto slot = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(x);
  };
  for_each_pixel(options, context, [&](int x, int y) { pixels[slot(x, y)] = painter.middle_of_pixel(x, y); });
  Flags is_edge(pixels.size(), 0);
  for_each_pixel(options, context, [&](int x, int y) {
    const Pixel& here = pixels[slot(x, y)];
    const float spacing = spacing_at(here.point, view, options);
    for (const auto& [dx, dy] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
      const int i = x + dx, j = y + dy;
      if (i < 0 || j < 0 || i >= options.width || j >= options.height) continue;
      if (!belong_together(here, pixels[slot(i, j)], spacing)) is_edge[slot(x, y)] = 1;
    }
  });
  for_each_pixel(options, context, [&](int x, int y) {
    if (is_edge[slot(x, y)]) pixels[slot(x, y)] = painter.pixel(x, y);
  });
}

// The data of the pixels that the filter uses, one array each: the two shares of light, and the normal and
// point of the surface. Rows are padded, so that loops along a row need no tests for the ends of it.
class LightFilter {
 public:
  LightFilter(const std::vector<Pixel>& pixels, const RenderOptions& options, const View& view)
      : options_(options), stride_(static_cast<std::size_t>(options.width) + 2 * padding) {
    const std::size_t size = stride_ * static_cast<std::size_t>(options.height);
    for (auto* values : {&normal_[0], &normal_[1], &normal_[2], &point_[0], &point_[1], &point_[2], &open_,
                         &key_, &plane_, &next_open_, &next_key_})
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

  // Runs the three passes, whose neighbours are 1, 2 and 4 pixels apart.
  void run(const Context& context) {
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

  float open(int x, int y) const { return open_[slot(x, y)]; }
  float key(int x, int y) const { return key_[slot(x, y)]; }

 private:
  static constexpr std::size_t lane_count = 4;  // pixels that are computed at once
  using Lanes [[gnu::vector_size(sizeof(float) * lane_count)]] = float;
  static constexpr std::size_t padding = 8 + lane_count;  // the last pass reaches 8 pixels far

  // Sums over the neighbours of a row's pixels.
  struct Sums {
    std::vector<float> weights, open, key;
  };

  std::size_t slot(int x, int y) const {
    return static_cast<std::size_t>(y) * stride_ + padding + static_cast<std::size_t>(x);
  }

  // Returns exp(-cost) to three digits, and 0 for costs above 9.
  static Lanes weight_of(Lanes cost) {
    constexpr float most = 9, weight_of_most = 1.3e-4f;
    const Lanes part = (cost < most ? cost : Lanes{} + most) * (1.0f / 64);
    Lanes weight = 1.0f - part + 0.5f * part * part;
    for (int k = 0; k < 6; ++k) weight *= weight;
    weight -= weight_of_most;
    return weight > 0.0f ? weight : Lanes{};
  }

  static Lanes load(const float* values) {
    Lanes lanes;
    std::memcpy(&lanes, values, sizeof(lanes));
    return lanes;
  }

  static void add(float* values, Lanes sum) {
    sum += load(values);
    std::memcpy(values, &sum, sizeof(sum));
  }

  // Averages neighbours `step` pixels apart that have similar shares and lie in one plane: a row of one pass of
  // an edge-avoiding wavelet filter (Dammertz et al. 2010).
  void smooth_row(int y, int step) {
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

  // Adds the neighbours of a row's pixels that are all equally far away. Both rows are given by their first
  // slots.
  void add_neighbours(std::size_t here, std::size_t there, float distance2, int step, Sums& sums) const {
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

  const RenderOptions& options_;
  std::size_t stride_;
  std::array<std::vector<float>, 3> normal_, point_;
  std::vector<float> open_, key_, plane_;  // plane_: over a distance from the plane, gives the root of a cost
  std::vector<float> next_open_, next_key_;
};

}  // namespace

Points vertex_colours(const Mesh& mesh) {
  const Attribute* colour = mesh.find_attribute(Domain::vertex, "colour");
  Points out(0, 3);
  if (!colour || colour->components < 3) return out;
  const bool bytes = colour->type == ScalarType::uint8;
  out.resize(mesh.vertex_count(), 3);
  for (Eigen::Index v = 0; v < out.rows(); ++v)
    for (int k = 0; k < 3; ++k) {
      const double value = colour->values[v * colour->components + k];
      out(v, k) = from_srgb(std::clamp(bytes ? value / 255.0 : value, 0.0, 1.0));
    }
  return out;
}

Image render(std::span<const Shape> shapes, const RenderOptions& options, const Context& context) {
  if (options.width < 1 || options.height < 1 || options.samples < 1)
    throw Error(
        facts::render::NoSize{.width = options.width, .height = options.height, .samples = options.samples});
  std::vector<Surface> surfaces;
  for (const Shape& shape : shapes) surfaces.push_back(prepare(shape, options, context));
  if (std::none_of(surfaces.begin(), surfaces.end(), [](const Surface& s) { return s.triangles.rows() > 0; }))
    throw Error(facts::render::NoFace{});
  const View view = fit_view(surfaces, options);
  const Painter painter(surfaces, view, options, context);

  context.step("render", 0.0);
  std::vector<Pixel> pixels(static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  const auto slot = [&](int x, int y) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(options.width) + static_cast<std::size_t>(x);
  };
  if (options.sparse && !options.wireframe)
    trace_sparsely(painter, view, options, pixels, context);
  else
    for_each_pixel(options, context, [&](int x, int y) { pixels[slot(x, y)] = painter.pixel(x, y); });
  context.step("render", 0.8);
  LightFilter light(pixels, options, view);
  light.run(context);
  Image image{options.width, options.height, std::vector<std::uint8_t>(3 * pixels.size())};
  if (options.transparent) image.cover.resize(pixels.size());
  const auto byte_of = [](float share) {
    return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(share, 0.0f, 1.0f)));
  };
  for_each_pixel(options, context, [&](int x, int y) {
    const std::size_t i = slot(x, y);
    Vec3 colour = pixels[i].plain + light.open(x, y) * pixels[i].by_open + light.key(x, y) * pixels[i].by_key;
    if (options.transparent) {
      image.cover[i] = byte_of(pixels[i].cover);
      colour /= std::max(pixels[i].cover, 1e-6f);  // that of the shapes alone
    }
    for (std::size_t k = 0; k < 3; ++k)
      image.pixels[3 * i + k] = byte_of(to_srgb(std::clamp(colour[static_cast<Eigen::Index>(k)], 0.0f, 1.0f)));
  });
  context.step("render", 1.0);
  return image;
}

}  // namespace meshgraft::render
