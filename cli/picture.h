#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "render/render.h"

namespace meshgraft::cli {

/// How a picture looks at meshes, as the options of a command say it.
struct View {
  std::vector<double> from{0.5, -1.0, 0.35}, up{0, 0, 1};
  int width = 1200, height = 900;
};

/// Of pictures that go along with a result: smaller, to be there soon.
inline constexpr int picture_width = 900, picture_height = 675;

/// `--from`, `--up`, `--width`, `--height`; the defaults are those of `view`.
std::vector<CLI::Option*> add_view(CLI::App& command, View& view);

/// `--picture` with those options, which go with it.
void add_picture(CLI::App& command, std::filesystem::path& picture, View& view, const std::string& description);

/// Throws Error(usage) for a view from nowhere or along `up`.
render::RenderOptions options_of(const View& view);

/// The same for pictures that go along with a result: with fewer rays, which a large picture shows.
render::RenderOptions quick_options_of(const View& view);

/// One picture per mesh, all seen alike and in the same frame.
std::vector<render::Image> make_pictures(std::span<const Mesh* const> meshes,
                                         const render::RenderOptions& options, const Context& context);

/// Pictures with captions in rows of equal length, at most `columns`; the last row may be shorter.
render::Image contact_sheet(std::span<const render::Image> images, std::span<const std::string> captions,
                            std::size_t columns);

/// Pictures of several meshes side by side, all seen alike and in the same frame; of one without its caption.
render::Image make_picture(std::span<const Mesh* const> meshes, std::span<const std::string> captions,
                           const render::RenderOptions& options, const Context& context);

}  // namespace meshgraft::cli
