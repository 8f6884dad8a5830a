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

/// The camera and the size of a picture, as the options of a command state them. Without `from`, the command
/// chooses the direction; without `up`, it is what the mesh's source says.
struct View {
  std::vector<double> from, up;
  int width = 1200, height = 900;
};

/// The size of pictures that accompany a result. They are smaller, so that they are drawn quickly.
inline constexpr int picture_width = 900, picture_height = 675;

/// Adds `--from`, `--up`, `--width` and `--height`. The defaults are those of `view`; `usual_direction` says
/// what the default of `--from` is.
std::vector<CLI::Option*> add_view(CLI::App& command, View& view, const std::string& usual_direction);

/// Adds `--picture` and the options of its view, which need it.
void add_picture(CLI::App& command, std::filesystem::path& picture, View& view, const std::string& description);

/// Throws Error(usage) if a direction is zero, or if both are given and parallel.
void check_view(const View& view);

/// Returns the renderer's options for pictures of a mesh. Throws what `check_view` throws, and Error(usage) if
/// the eye looks along what is up in the mesh.
render::RenderOptions options_of(const View& view, const Mesh& mesh);

/// Returns the options for pictures that accompany a result. They use fewer rays, which shows in a large
/// picture.
render::RenderOptions quick_options_of(const View& view, const Mesh& mesh);

/// Turns a camera to what differs between the first mesh and the others.
void look_at_change(render::Camera& camera, std::span<const Mesh* const> meshes, const View& view,
                    const Context& context);

/// Draws one picture per mesh, all with the same camera and in the same frame: the camera's, or that of all
/// meshes.
std::vector<render::Image> make_pictures(std::span<const Mesh* const> meshes,
                                         const render::RenderOptions& options, const Context& context);

/// Arranges pictures with captions in rows of equal length, at most `columns`. The last row may be shorter.
render::Image contact_sheet(std::span<const render::Image> images, std::span<const std::string> captions,
                            std::size_t columns);

/// Draws a mesh before and after a change, with a camera that looks at what changed.
render::Image make_comparison(const Mesh& before, const Mesh& after, const View& view, const Context& context);

/// Draws several meshes side by side with the same camera and in the same frame. A single mesh has no
/// caption.
render::Image make_picture(std::span<const Mesh* const> meshes, std::span<const std::string> captions,
                           const render::RenderOptions& options, const Context& context);

}  // namespace meshgraft::cli
