#pragma once

#include <cstddef>
#include <span>
#include <string>

#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Maps a mesh by an affine map. Attributes called "normal" or `cut_normal_name` are mapped by the inverse
/// transpose; others keep their values. A map that reflects also reverses the faces, so that the outside
/// stays outside. Throws Error(input), naming `location`, for a singular map.
Mesh transformed(const Mesh& mesh, const Eigen::Affine3d& map, const Location& location);

/// Returns the reflection in a plane. Throws Error(input), naming `location`, for a normal of zero length.
Eigen::Affine3d reflection(const Plane& plane, const Location& location);

/// Fewest pairs of vertices that determine a similarity.
inline constexpr std::size_t fewest_aligned_pairs = 3;

/// Returns the similarity that brings the source's vertices of three or more pairs nearest to the target's in
/// the least-squares sense (Umeyama 1991). Throws Error(input), naming `pairs` or one of them, for fewer
/// pairs, vertices that do not exist, and vertices of either mesh that lie on a line.
Eigen::Affine3d align_source(const Mesh& source, const Mesh& target, std::span<const Match> pairs);

}  // namespace meshgraft
