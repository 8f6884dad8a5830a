#include "picture.h"

#include <limits>

namespace meshgraft::cli {

void write_picture(std::span<const Mesh* const> meshes, std::span<const std::string> captions,
                   const render::RenderOptions& options, const std::filesystem::path& path,
                   const Context& context) {
  render::RenderOptions shared = options;
  shared.camera.low.setConstant(std::numeric_limits<double>::infinity());
  shared.camera.high.setConstant(-std::numeric_limits<double>::infinity());
  for (const Mesh* mesh : meshes) {
    for (const auto& position : mesh->positions.rowwise()) {
      if (!position.allFinite()) continue;
      shared.camera.low = shared.camera.low.cwiseMin(position.transpose());
      shared.camera.high = shared.camera.high.cwiseMax(position.transpose());
    }
  }
  std::vector<render::Image> images;
  for (const Mesh* mesh : meshes) {
    const render::Shape shape{mesh, render::vertex_colours(*mesh)};
    images.push_back(render::render({&shape, 1}, shared, context));
  }
  render::write_png(images.size() == 1 ? images.front() : render::side_by_side(images, captions), path);
}

}  // namespace meshgraft::cli
