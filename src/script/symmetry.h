#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/core/error.h>
#include <meshgraft/deform/deform_problem.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/select/selection.h>

#include "resolve_deform.h"

namespace meshgraft {

/// How far the mirror images of some vertices are from any vertex.
struct Lack {
  double distance_rel = 0;              ///< at most, × the mesh's diagonal
  std::optional<double> tolerance_rel;  ///< finds a partner for each; absent where images are too far off
};

/// Matches the vertices of a mesh with those of its mirror image. On a symmetric mesh every vertex has one
/// partner, and the relation is mutual. On a nearly symmetric mesh several vertices may share a partner.
class MirrorMatch {
 public:
  /// `location` is that of the field `symmetry`. Throws Error(input) for an invalid plane.
  MirrorMatch(const SymmetrySpec& symmetry, const SelectionMesh& context, Location location);

  const Eigen::Affine3d& reflection() const { return reflection_; }

  /// Returns the vertex nearest to the mirror image of `v`. Returns -1 where none is within tolerance, or `v`
  /// belongs to no face.
  Index partner(Index v) const { return partner_[v]; }

  /// Returns the partner of `v`. Throws Error(input), naming `where`, where there is none: with the id
  /// script.vertex_without_mirror_image if a larger tolerance finds one, else script.vertex_not_mirrored.
  Index required_partner(Index v, const Location& where) const;

  /// Returns `set` (ascending) and its mirror images: the partners of its vertices, and the vertices whose
  /// partners are in `set`. The latter fill holes where the two sides are triangulated differently.
  std::vector<Index> with_images(const std::vector<Index>& set) const;

  /// Returns the handle of the mirror images of `handle`. Returns nothing for a handle that is its own mirror
  /// image, and extends it to hold all of its images. Throws Error(input), naming `where`, for a handle that
  /// partly overlaps its image (script.overlaps_mirror_image), and for one with vertices that have no partner
  /// (script.no_mirror_image if a larger tolerance finds one for each, else script.not_mirrored).
  std::optional<Handle> twin_of(Handle& handle, const Location& where) const;

  /// Returns the vertices of `set` that belong to a face and have no partner, ascending.
  std::vector<Index> without_partner(const std::vector<Index>& set) const;

  /// Returns the vertices of `set` whose mirror images are farther from any vertex than their longest edge.
  std::vector<Index> beyond_edges(const std::vector<Index>& set) const;

  /// Returns `set` and all vertices whose mirror image has its nearest vertex in `set`, whatever the tolerance.
  std::vector<Index> with_nearest_images(const std::vector<Index>& set) const;

  /// Returns the error about vertices whose mirror images are beyond edges, of so many of the region.
  Error refusal_of(const std::vector<Index>& beyond, std::size_t of, const Location& where) const;

  /// Returns a note about vertices without a partner.
  Note note_about(const std::vector<Index>& without_partner, std::size_t of) const;

 private:
  std::vector<Index> images(const std::vector<Index>& set) const;
  std::vector<Index> course_of_images(const Handle& handle, const Location& where) const;
  bool is_own_image(const Handle& handle) const;
  void require_partners(const Handle& handle, const Location& where) const;
  void require_face(Index v, const Location& where) const;
  Lack lack_of(const std::vector<Index>& vertices) const;
  double image_distance(Index v) const { return distance_[v]; }

  const SelectionMesh& context_;
  Location location_;
  Eigen::Affine3d reflection_;
  double tolerance_rel_ = 0, diagonal_ = 0;
  std::vector<Index> partner_;
  std::vector<double> distance_;  ///< from the mirror image to the nearest vertex; negative: belongs to no face
};

/// A region together with its mirror image.
struct MirroredRegion {
  std::vector<Index> own;    ///< both sides, or the side to which the plane's normal points
  std::vector<Index> image;  ///< the other side; empty if both sides are in `own`, because an edge joins them
  Eigen::Affine3d reflection = Eigen::Affine3d::Identity();
  Index without_partner = 0;  ///< vertices of the region
  std::optional<Note> note;   ///< about these
};

/// Mirrors a region (ascending). The result is the same for the region, its image, and both together.
/// `location` is that of the field `symmetry`. On a nearly symmetric mesh, vertices without a partner are
/// mirrored to where the surface is nearest, with a note. Throws Error(input) for an invalid plane, and if
/// mirror images of the region are farther from any vertex than an edge: an image with gaps would leave spikes.
MirroredRegion mirrored_region(const std::vector<Index>& region, const SymmetrySpec& symmetry,
                               const SelectionMesh& context, const Location& location);

/// Returns whether the pose of a handle that is its own mirror image is symmetric, too, to rounding.
bool is_symmetric(const HandlePose& pose, const Handle& handle, const Points& rest,
                  const Eigen::Affine3d& reflection);

/// Returns the pose of the twin of a handle. `pose` is the handle's pose and `spec` its specification in the
/// edit.
HandlePose twin_pose(const PoseSpec& spec, const HandlePose& pose, const Handle& twin, const Points& rest,
                     const Eigen::Affine3d& reflection);

}  // namespace meshgraft
