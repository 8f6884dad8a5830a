#pragma once

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/script/edit_file.h>

#include "picture.h"

namespace meshgraft::cli {

/// The edit's inputs, the first merge's target first, and its result side by side; each in a frame of its own,
/// for parts come in any size. Throws what `load_input` throws.
render::Image picture_of_parts(const EditFile& edit, const Mesh& result, const View& view,
                               const Context& context);

}  // namespace meshgraft::cli
