#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/edit_file.h>

#include "picture.h"

namespace meshgraft::cli {

/// Draws the edit's inputs and its result side by side. The input that the first merge grafts onto comes first,
/// and all are seen from where most of what was added is seen. Each has a frame of its own, because parts
/// differ in size. Throws the errors of `load_input`.
render::Image picture_of_parts(const EditFile& edit, const Mesh& result, const View& view,
                               const Context& context);

}  // namespace meshgraft::cli
