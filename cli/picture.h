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

/// The camera and the size of a picture, as the options of a command state them.
struct View {
  std::vector<double> from{0.5, -1.0, 0.35}, up{0, 0, 1};
  int width = 1200, height = 900;
};

/// The size of pictures that accompany a result. They are smaller, so that they are drawn quickly.
inline constexpr int picture_width = 900, picture_height = 675;

/// Adds `--from`, `--up`, `--width` and `--height`. The defaults are those of `view`.
std::vector<CLI::Option*> add_view(CLI::App& command, View& view);

/// Adds `--picture` and the options of its view, which need it.
void add_picture(CLI::App& command, std::filesystem::path& picture, View& view, const std::string& description);

/// Returns the renderer's options. Throws Error(usage) if a direction is zero or if both are parallel.
render::RenderOptions options_of(const View& view);

/// Returns the options for pictures that accompany a result. They use fewer rays, which shows in a large
/// picture.
render::RenderOptions quick_options_of(const View& view);

/// Draws one picture per mesh, all with the same camera and in the same frame.
std::vector<render::Image> make_pictures(std::span<const Mesh* const> meshes,
                                         const render::RenderOptions& options, const Context& context);

/// Arranges pictures with captions in rows of equal length, at most `columns`. The last row may be shorter.
render::Image contact_sheet(std::span<const render::Image> images, std::span<const std::string> captions,
                            std::size_t columns);

/// Draws several meshes side by side with the same camera and in the same frame. A single mesh has no
/// caption.
render::Image make_picture(std::span<const Mesh* const> meshes, std::span<const std::string> captions,
                           const render::RenderOptions& options, const Context& context);

}  // namespace meshgraft::cli
