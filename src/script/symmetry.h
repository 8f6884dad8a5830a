#pragma once

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <meshgraft/deform/handle.h>
#include <meshgraft/deform/selection.h>
#include <meshgraft/script/edit_file.h>
#include <meshgraft/script/resolve_deform.h>

namespace meshgraft {

/// The mesh and its mirror image: which vertices lie where. On a mesh that is its own mirror image every vertex
/// has one partner and is that one's; on one that nearly is, several may share a partner.
class MirrorMatch {
 public:
  /// `location` is that of the field `symmetry`. Throws Error(input) for a plane that is none.
  MirrorMatch(const SymmetrySpec& symmetry, const SelectionContext& context, std::string location);

  const Eigen::Affine3d& reflection() const { return reflection_; }

  /// The vertex nearest to the mirror image of `v`; -1 where none is within tolerance, or `v` is of no face.
  Index partner(Index v) const { return partner_[static_cast<std::size_t>(v)]; }

  /// The same. Throws Error(input), naming `where`, where there is none.
  Index required_partner(Index v, const std::string& where) const;

  /// `set` (ascending) and its mirror images: the partners of its vertices, and those whose partners its
  /// vertices are. The latter leave no holes where the two sides are triangulated differently.
  std::vector<Index> with_images(const std::vector<Index>& set) const;

  /// The handle of the mirror images of `handle`; none where it is its own mirror image, and then it is made to
  /// hold all of its images. Throws Error(input), naming `where`, for a handle that overlaps its image in part,
  /// and for one some of whose vertices have no partner.
  std::optional<Handle> twin_of(Handle& handle, const std::string& where) const;

  /// Those of `set` that are of a face and have no partner, ascending.
  std::vector<Index> without_partner(const std::vector<Index>& set) const;

  /// A sentence about such vertices.
  std::string note_about(const std::vector<Index>& without_partner, std::size_t of) const;

 private:
  std::vector<Index> images(const std::vector<Index>& set) const;
  std::vector<Index> course_of_images(const Handle& handle, const std::string& where) const;
  bool is_own_image(const Handle& handle) const;
  void require_partners(const Handle& handle, const std::string& where) const;
  std::string sufficient_tolerance(const std::vector<Index>& vertices) const;
  double image_distance(Index v) const { return distance_[static_cast<std::size_t>(v)]; }

  const SelectionContext& context_;
  std::string location_;
  Eigen::Affine3d reflection_;
  double tolerance_rel_ = 0, diagonal_ = 0;
  std::vector<Index> partner_;
  std::vector<double> distance_;  ///< from the mirror image to the nearest vertex; negative: of no face
};

/// Whether the pose of a handle that is its own mirror image is so, too, to rounding.
bool is_symmetric(const HandlePose& pose, const Handle& handle, const Points& rest,
                  const Eigen::Affine3d& reflection);

/// The pose of the twin of a handle that has `pose`, of which `spec` is what the edit says.
HandlePose twin_pose(const PoseSpec& spec, const HandlePose& pose, const Handle& twin, const Points& rest,
                     const Eigen::Affine3d& reflection);

}  // namespace meshgraft
