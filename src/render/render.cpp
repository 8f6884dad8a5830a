#include "render/render.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <meshgraft/core/error.h>

#include "core/parallel.h"
#include "light_filter.h"
#include "painter.h"
#include "render/facts.h"

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
bool belong_together(const Pixel& here, const Pixel& there, float spacing) {
  constexpr float least_cosine = 0.96f, most_colour = 0.06f;
  if (here.normal.isZero(0) != there.normal.isZero(0)) return false;
  if (here.normal.isZero(0)) return true;
  return here.normal.dot(there.normal) > least_cosine &&
         std::abs(here.normal.dot(there.point - here.point)) < spacing &&
         (here.point - there.point).squaredNorm() < 100 * spacing * spacing &&
         (here.plain - there.plain + 0.5f * (here.by_open - there.by_open)).cwiseAbs().maxCoeff() < most_colour;
}

/// Traces all pixels by one ray each, and again by all samples where a neighbour shows something else.
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
  std::erase_if(surfaces, [](const Surface& surface) { return surface.triangles.rows() == 0; });
  if (surfaces.empty()) throw Error(facts::render::NoFace{});
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
