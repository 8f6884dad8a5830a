#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"

namespace meshgraft::test {

/// Returns a handle that constrains positions and transforms.
Handle make_handle(std::string name, std::vector<Index> vertices);

/// Returns a region of the whole mesh whose handles are the foot and the head, in this order.
Region two_handles(const Scene& scene);

/// Returns a region of the whole mesh whose foot is fixed and whose only handle is the head.
Region held_foot(const Scene& scene);

HandlePose pose_of(const Eigen::Affine3d& map);

/// Returns `linear` about the middle of the mesh's box, with a shift by a fraction of its diagonal.
Eigen::Affine3d about_middle(const TestMesh& mesh, const Eigen::Matrix3d& linear);

/// Returns linear maps of different kinds: shear, unequal scales, reflection, turn.
std::vector<std::pair<std::string, Eigen::Matrix3d>> linear_maps();

/// Returns the head's move in edits that are not affine: a turn by 63°, a scale and a shift.
Eigen::Affine3d head_move(const Scene& scene);

Points image(const Points& points, const Eigen::Affine3d& map);

/// Returns the largest distance between corresponding vertices.
double largest_distance(const Points& a, const Points& b);

/// Returns 8 units in the last place of the largest coordinate, a bound for errors by rounding coordinates.
double eight_ulp(const Points& points);

/// The affine map that best takes some vertices from `rest` to `moved`. `misfit` is the norm of its error
/// relative to that of the moved positions.
struct AffineFit {
  Eigen::Affine3d map;
  double misfit = 0;
};
AffineFit fit_affine(const Points& rest, const Points& moved, const std::vector<Index>& vertices);

bool same_bytes(const Points& a, const Points& b);

}  // namespace meshgraft::test
