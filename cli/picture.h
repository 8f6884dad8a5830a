#pragma once

#include <filesystem>
#include <span>
#include <string>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

#include "render/render.h"

namespace meshgraft::cli {

/// Pictures of several meshes side by side, all seen alike and in the same frame, as a PNG file.
void write_picture(std::span<const Mesh* const> meshes, std::span<const std::string> captions,
                   const render::RenderOptions& options, const std::filesystem::path& path,
                   const Context& context);

}  // namespace meshgraft::cli
