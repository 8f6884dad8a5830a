#include "picture.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>

#include "choices.h"
#include "cli/facts.h"
#include "render/viewpoint.h"

namespace meshgraft::cli {

std::vector<CLI::Option*> add_view(CLI::App& command, View& view, const std::string& usual_direction) {
  const std::string direction =
      fmt::format("Direction from the model to the eye (default: {})", usual_direction);
  return {
      command.add_option("--from", view.from, direction)
          ->expected(3)
          ->type_name("X Y Z")
          ->check(finite_number()),
      command
          .add_option("--up", view.up,
                      "Direction that is up (default: the axis y or z that is up in the model)")
          ->expected(3)
          ->type_name("X Y Z")
          ->check(finite_number()),
      command.add_option("--width", view.width, fmt::format("Pixels per picture (default {})", view.width))
          ->type_name("N")
          ->check(whole_number_from(16, 4096)),
      command.add_option("--height", view.height, fmt::format("Pixels (default {})", view.height))
          ->type_name("N")
          ->check(whole_number_from(16, 4096)),
  };
}

void add_picture(CLI::App& command, std::filesystem::path& picture, View& view,
                 const std::string& description) {
  CLI::Option* option = command.add_option("--picture", picture, description)->type_name("FILE");
  for (CLI::Option* of_view : add_view(command, view, "one that shows what changed")) of_view->needs(option);
}

namespace {

// Returns a direction of unit length.
Eigen::Vector3d direction(const std::vector<double>& given, const char* option) {
  const Eigen::Map<const Eigen::Vector3d> vector(given.data());
  if (vector.isZero(0)) throw Error(facts::cli::NoDirection{}, option);
  return vector.stableNormalized();
}

void require_not_along(const Eigen::Vector3d& from, const Eigen::Vector3d& up) {
  if (!(up.cross(from).norm() > 1e-9)) throw Error(facts::cli::EyeAlongUp{}, "--from");
}

}  // namespace

void check_view(const View& view) {
  if (!view.up.empty()) direction(view.up, "--up");
  if (!view.from.empty()) direction(view.from, "--from");
  if (!view.up.empty() && !view.from.empty())
    require_not_along(direction(view.from, "--from"), direction(view.up, "--up"));
}

render::RenderOptions options_of(const View& view, const Mesh& mesh) {
  render::RenderOptions options;
  options.width = view.width;
  options.height = view.height;
  render::Camera& camera = options.camera;
  camera.up = view.up.empty() ? render::up_of(mesh) : direction(view.up, "--up");
  camera.from_direction =
      view.from.empty() ? render::usual_direction(camera.up) : direction(view.from, "--from");
  require_not_along(camera.from_direction, camera.up);
  return options;
}

render::RenderOptions quick_options_of(const View& view, const Mesh& mesh) {
  render::RenderOptions options = options_of(view, mesh);
  options.occlusion_rays = 8;
  options.sparse = true;
  return options;
}

void look_at_change(render::Camera& camera, std::span<const Mesh* const> meshes, const View& view,
                    const Context& context) {
  if (view.from.empty())
    camera.from_direction = render::direction_to_change(*meshes.front(), *meshes.back(), camera.up, context);
  const Eigen::AlignedBox3d box = render::box_of_change(meshes, context);
  camera.low = box.min();
  camera.high = box.max();
}

std::vector<render::Image> make_pictures(std::span<const Mesh* const> meshes,
                                         const render::RenderOptions& options, const Context& context) {
  render::RenderOptions shared = options;
  if ((shared.camera.low.array() > shared.camera.high.array()).any()) {
    const Eigen::AlignedBox3d box = render::box_of(meshes);
    shared.camera.low = box.min();
    shared.camera.high = box.max();
  }
  std::vector<render::Image> images;
  for (const Mesh* mesh : meshes) {
    const render::Shape shape{mesh, render::vertex_colours(*mesh)};
    images.push_back(render::render({&shape, 1}, shared, context));
  }
  return images;
}

render::Image make_comparison(const Mesh& before, const Mesh& after, const View& view, const Context& context) {
  const std::vector<const Mesh*> meshes{&before, &after};
  render::RenderOptions options = quick_options_of(view, after);
  look_at_change(options.camera, meshes, view, context);
  return make_picture(meshes, std::vector<std::string>{"before", "after"}, options, context);
}

render::Image contact_sheet(std::span<const render::Image> images, std::span<const std::string> captions,
                            std::size_t columns) {
  const std::size_t row_count = (images.size() + columns - 1) / columns;
  const std::size_t row_length = (images.size() + row_count - 1) / row_count;
  std::vector<render::Image> rows;
  for (std::size_t first = 0; first < images.size(); first += row_length) {
    const std::size_t length = std::min(row_length, images.size() - first);
    rows.push_back(render::side_by_side(images.subspan(first, length), captions.subspan(first, length)));
  }
  return render::stacked(rows);
}

render::Image make_picture(std::span<const Mesh* const> meshes, std::span<const std::string> captions,
                           const render::RenderOptions& options, const Context& context) {
  std::vector<render::Image> images = make_pictures(meshes, options, context);
  return images.size() == 1 ? std::move(images.front()) : render::side_by_side(images, captions);
}

}  // namespace meshgraft::cli
