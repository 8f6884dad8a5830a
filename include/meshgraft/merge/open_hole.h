#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Where and how a part is put onto a surface without a hole.
struct Drop {
  std::variant<Index, Eigen::Vector3d>
      surface_point;  ///< a vertex of the target, or the surface nearest to a point
  /// Scale of the source, about. Absent: 1 if its loop has room there and the source stands clear of the
  /// target, else the largest of 0.7, 0.5, 0.35, … that does.
  std::optional<double> size{};
  /// Turn about the target's normal, right hand. At 0 the part is turned as little as possible from how it
  /// stands in its own coordinates.
  double spin_deg = 0;
};

/// A target with a hole for a source's loop.
struct OpenedHole {
  Mesh target;
  IndexMap vertex;  ///< target's vertices → `target`; -1 within the hole
  MergePair pair;   ///< the two loops, and vertices of them that meet
  double size = 1;  ///< of the source
  /// The source does not cut through the target there, as it would stand undeformed.
  bool clear = true;
  std::vector<std::string> notes;  ///< sentences for people
};

/// Opens a hole of the shape of a source's boundary loop, to be passed on to `merge` with `size` locked.
///
/// The loop, projected along its area vector, is laid around the point: along the surface, by the discrete
/// exponential map (Schmidt, Grimm and Wyvill 2006, "Interactive decal compositing with discrete exponential
/// maps"), about the target's normal averaged over the loop's radius, and enlarged on curved surfaces until it
/// is as wide there as the loop. Edges that are too long to draw it are halved. All vertices outside the hole
/// keep their positions; only those on its edge may have moved, along edges.
///
/// Throws Error(input), naming `surface_point`, `size` or the loop: a vertex that does not exist or is on the
/// boundary, a point farther from the surface than a twentieth of the target's diagonal, a `source_loop` that
/// is none or spans no area, a size below a millionth of the target's; and a given size whose hole would reach
/// a boundary, an edge of three faces, or all round the surface, or where the surface is too narrow to be as
/// wide (0.85) as the loop: the message names the largest size that fits.
OpenedHole open_hole(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop,
                     const Drop& drop, const Context& context = {});

/// Where a part stands that is dropped, before it is bent. No hole is opened, so that this follows a pointer:
/// the constructor does what does not depend on the point.
class DropGuide {
 public:
  /// Throws Error(input) as `open_hole` for a loop that is none.
  DropGuide(std::shared_ptr<const Mesh> target, const Mesh& source, const std::vector<Index>& source_loop,
            const Context& context = {});

  /// The similarity of the source's coordinates, in the size of `drop` (absent: its own), that lays its loop
  /// level with the surface around the point. Throws Error(input) as `open_hole` for a point that it refuses.
  Eigen::Affine3d pose(const Drop& drop) const;

 private:
  struct Prepared;
  std::shared_ptr<const Prepared> prepared_;
};

}  // namespace meshgraft
