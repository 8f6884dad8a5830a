#include "render/render.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "corner_normals.h"
#include "light_grid.h"
#include "light_rays.h"
#include "painter.h"
#include "render/facts.h"
#include "samples.h"
#include "visible_triangles.h"

namespace meshgraft::render {

namespace {

double from_srgb(double value) {
  return value <= 0.04045 ? value / 12.92 : std::pow((value + 0.055) / 1.055, 2.4);
}

float to_srgb(float value) {
  return value <= 0.0031308f ? 12.92f * value : 1.055f * std::pow(value, 1.0f / 2.4f) - 0.055f;
}

/// Runs body(x, y) for all pixels, tile by tile.
template <typename Body>
void for_each_pixel(const RenderOptions& options, const Context& context, Body body) {
  constexpr int tile_side = 16;
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

/// Returns whether two neighbouring pixels show parts of one smooth surface in nearly the same colours.
bool belong_together(const Appearance& here, const Appearance& there, float spacing) {
  constexpr float least_cosine = 0.96f, most_colour = 0.06f;
  if (here.needs_light() != there.needs_light()) return false;
  if (!here.needs_light()) return true;
  return here.normal.dot(there.normal) > least_cosine &&
         std::abs(here.normal.dot(there.point - here.point)) < spacing &&
         (here.point - there.point).squaredNorm() < 100 * spacing * spacing &&
         (here.plain - there.plain + 0.5f * (here.by_open - there.by_open)).cwiseAbs().maxCoeff() < most_colour;
}

/// Makes a picture of a scene, step by step.
class Renderer {
 public:
  Renderer(const Scene& scene, const RenderOptions& options, const Context& context)
      : scene_(scene),
        options_(options),
        context_(context),
        view_(fit_view(scene, options)),
        points_(in_view()),
        rays_(points_, scene.triangles, view_, context),
        normals_(points_, scene.triangles, options, context),
        painter_(scene_, points_, normals_, view_, options_, rays_.lift()),
        middles_(options.width, options.height),
        looks_(look_at_middles()),
        light_(looks_, view_) {}

  Image draw() {
    if (options_.sparse)
      light_.trace(looks_, rays_, 4, 1, context_);
    else
      light_.trace(looks_, rays_, sky_rays(), options_.samples, context_);
    light_.smooth(context_);
    context_.step("render", 0.5);
    colours_.resize(looks_.size());
    cover_.assign(looks_.size(), 0.0f);
    const Flags left = draw_by_middles();
    context_.step("render", 0.6);
    draw_by_samples(left);
    return developed();
  }

 private:
  std::vector<Vec3> in_view() const {
    std::vector<Vec3> points(scene_.vertex_count());
    std::size_t first = 0;
    for (const auto& [positions, offset] : scene_.parts) {
      const auto count = static_cast<std::size_t>(positions->rows());
      parallel_blocks(
          count,
          [&](std::size_t begin, std::size_t end) {
            for (std::size_t v = begin; v < end; ++v) {
              const Vec3 point = view_.coordinates_of(positions->row(static_cast<Eigen::Index>(v)) + offset);
              points[first + v] = point.allFinite() ? point : Vec3::Zero();
            }
          },
          context_, 4096);
      first += count;
    }
    return points;
  }

  std::vector<std::uint32_t> seen_by(const Samples& samples) {
    std::vector<std::uint32_t> seen = visible_triangles(points_, scene_.triangles, view_, samples, context_);
    normals_.add(seen, context_);
    return seen;
  }

  std::vector<Appearance> look_at_middles() {
    context_.step("render", 0.1);
    const std::vector<std::uint32_t> seen = seen_by(middles_);
    std::vector<Appearance> looks(seen.size());
    for_each_pixel(options_, context_, [&](int x, int y) {
      const std::size_t pixel = middles_.pixel(x, y);
      looks[pixel] = painter_.at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, seen[pixel]);
    });
    return looks;
  }

  bool is_edge(int x, int y) const {
    const Appearance& here = looks_[middles_.pixel(x, y)];
    const float spacing = view_.spacing_at(here.point);
    for (const auto& [dx, dy] : {std::pair{-1, 0}, std::pair{1, 0}, std::pair{0, -1}, std::pair{0, 1}}) {
      const int i = x + dx, j = y + dy;
      if (i < 0 || j < 0 || i >= options_.width || j >= options_.height) continue;
      if (!belong_together(here, looks_[middles_.pixel(i, j)], spacing)) return true;
    }
    return false;
  }

  /// Colours pixels by what is in their middle, and returns which ones need more samples: in a sparse picture
  /// those beside another surface or colour, otherwise all.
  Flags draw_by_middles() {
    Flags left(looks_.size(), 1);
    if (!options_.sparse || options_.wireframe) return left;
    for_each_pixel(options_, context_, [&](int x, int y) {
      const std::size_t pixel = middles_.pixel(x, y);
      const Appearance& look = looks_[pixel];
      if (is_edge(x, y)) return;
      const auto light = light_at(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, look);
      if (!light) return;
      colours_[pixel] = look.lit_by(*light);
      cover_[pixel] = look.on_shape ? 1.0f : 0.0f;
      left[pixel] = 0;
    });
    return left;
  }

  /// Colours the chosen pixels by several samples, some rows at a time, for memory.
  void draw_by_samples(const Flags& chosen) {
    constexpr std::size_t most_samples = std::size_t{1} << 23;
    const int side = std::max(1, static_cast<int>(std::sqrt(static_cast<double>(options_.samples) + 1e-9)));
    const auto width = static_cast<std::size_t>(options_.width);
    const std::size_t in_row = width * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    const std::size_t band = std::max<std::size_t>(1, most_samples / in_row) * width;
    for (std::size_t begin = 0; begin < chosen.size(); begin += band) {
      const std::size_t end = std::min(begin + band, chosen.size());
      Flags in_band(chosen.size(), 0);
      std::copy(chosen.begin() + static_cast<std::ptrdiff_t>(begin),
                chosen.begin() + static_cast<std::ptrdiff_t>(end),
                in_band.begin() + static_cast<std::ptrdiff_t>(begin));
      draw_band(Samples(options_.width, options_.height, side, in_band));
      context_.step("render", 0.6 + 0.4 * static_cast<double>(end) / static_cast<double>(chosen.size()));
    }
  }

  void draw_band(const Samples& samples) {
    const std::vector<std::uint32_t> seen = seen_by(samples);
    for_each_pixel(options_, context_, [&](int x, int y) {
      const std::size_t pixel = samples.pixel(x, y), first = samples.first(pixel);
      if (first == Samples::none) return;
      Vec3 colour = Vec3::Zero();
      float cover = 0.0f;
      for (std::size_t s = 0; s < samples.per_pixel(); ++s) {
        const Eigen::Vector2f place = samples.place(x, y, s);
        const Appearance look = painter_.at(place.x(), place.y(), seen[first + s]);
        const auto light = light_at(place.x(), place.y(), look);
        const auto set = static_cast<std::uint32_t>(pixel), number = static_cast<std::uint32_t>(s);
        colour += look.lit_by(light ? *light
                                    : rays_.light_at(look, {set, number, std::max(1, options_.occlusion_rays),
                                                            options_.samples}));
        cover += look.on_shape ? 1.0f : 0.0f;
      }
      colours_[pixel] = colour / static_cast<float>(samples.per_pixel());
      cover_[pixel] = cover / static_cast<float>(samples.per_pixel());
    });
  }

  int sky_rays() const { return std::max(1, options_.occlusion_rays); }

  std::optional<Light> light_at(float x, float y, const Appearance& look) const {
    return look.needs_light() ? light_.at(x, y, look) : Light{};
  }

  Image developed() const {
    Image image{options_.width, options_.height, std::vector<std::uint8_t>(3 * colours_.size())};
    if (options_.transparent) image.cover.resize(colours_.size());
    const auto byte_of = [](float share) {
      return static_cast<std::uint8_t>(std::lround(255.0f * std::clamp(share, 0.0f, 1.0f)));
    };
    for_each_pixel(options_, context_, [&](int x, int y) {
      const std::size_t pixel = middles_.pixel(x, y);
      Vec3 colour = colours_[pixel];
      if (options_.transparent) {
        image.cover[pixel] = byte_of(cover_[pixel]);
        colour /= std::max(cover_[pixel], 1e-6f);  // that of the shapes alone
      }
      for (std::size_t k = 0; k < 3; ++k)
        image.pixels[3 * pixel + k] =
            byte_of(to_srgb(std::clamp(colour[static_cast<Eigen::Index>(k)], 0.0f, 1.0f)));
    });
    return image;
  }

  const Scene& scene_;
  const RenderOptions& options_;
  const Context& context_;
  const View view_;
  const std::vector<Vec3> points_;  // vertices in the coordinates of the camera
  const LightRays rays_;
  CornerNormals normals_;
  const Painter painter_;
  const Samples middles_;
  const std::vector<Appearance> looks_;  // by pixel
  LightGrid light_;
  std::vector<Vec3> colours_;  // by pixel
  std::vector<float> cover_;
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
  const Scene scene = make_scene(shapes, options);
  context.step("render", 0.0);
  Image image = Renderer(scene, options, context).draw();
  context.step("render", 1.0);
  return image;
}

}  // namespace meshgraft::render
