#pragma once

#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/deform/deformer.h>

#include "support/mesh_families.h"

namespace meshgraft::test {

/// A handle with both position and transform.
Handle make_handle(std::string name, std::vector<Index> vertices);

/// The whole mesh is the region; both ends are handles, foot first.
Region two_handles(const Scene& scene);

/// The whole mesh is the region; the foot is fixed, the head is the one handle.
Region held_foot(const Scene& scene);

HandlePose pose_of(const Eigen::Affine3d& map);

/// `linear` about the middle of the mesh's box, and a shift by a part of its diagonal.
Eigen::Affine3d about_middle(const TestMesh& mesh, const Eigen::Matrix3d& linear);

/// Linear maps without anything in common: shear, unequal scales, reflection, turn.
std::vector<std::pair<std::string, Eigen::Matrix3d>> linear_maps();

/// The head's move in edits that no affine map makes: turned by 63°, scaled, shifted.
Eigen::Affine3d head_move(const Scene& scene);

Points image(const Points& points, const Eigen::Affine3d& map);

/// Largest distance of a vertex from where it should be.
double largest_distance(const Points& a, const Points& b);

/// What rounding the coordinates themselves may cost: 8 units in the last place of the largest.
double eight_ulp(const Points& points);

/// The affine map that takes some vertices from `rest` to `moved` best, and by how much it fails to, relative
/// to the moved positions.
struct AffineFit {
  Eigen::Affine3d map;
  double misfit = 0;
};
AffineFit fit_affine(const Points& rest, const Points& moved, const std::vector<Index>& vertices);

bool same_bytes(const Points& a, const Points& b);

}  // namespace meshgraft::test
