#pragma once

#include <span>

#include <Eigen/Geometry>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/orientation.h>

#include "render.h"

namespace meshgraft::render {

/// Returns the direction that is up in a mesh's coordinates: what its source tells, else z.
Eigen::Vector3d up_of(const Mesh& mesh);

/// Returns the direction towards the eye that a camera has by default: from the front, a little from the right
/// and from above, in a world with this direction up.
Eigen::Vector3d usual_direction(const Eigen::Vector3d& up);

/// Returns the same for a model that stands like this.
Eigen::Vector3d usual_direction(const Orientation& orientation);

/// Returns the bounding box of several meshes. Coordinates that are not finite do not count.
Eigen::AlignedBox3d box_of(std::span<const Mesh* const> meshes);

/// Returns the box of the faces that the first mesh does not share with another one, with a margin of half its
/// longest side. Returns the box of all meshes if the diagonal of the former is above 40 % of the latter's, or
/// if all faces are shared. A face is shared if its corners are at the same positions.
Eigen::AlignedBox3d box_of_change(std::span<const Mesh* const> meshes, const Context& context = {});

/// Returns the direction towards the eye from which most of what differs between two meshes is seen on `after`.
/// It is `usual_direction` unless another one shows clearly more.
Eigen::Vector3d direction_to_change(const Mesh& before, const Mesh& after, const Eigen::Vector3d& up,
                                    const Context& context = {});

}  // namespace meshgraft::render
