#pragma once

#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <Eigen/Geometry>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/mesh/mesh.h>

#include "flat_loop.h"

namespace meshgraft {

/// A target with a hole for a source's loop.
struct OpenedHole {
  Mesh target;
  IndexMap vertex;  ///< vertices of the given target → `target`; -1 within the hole
  MergePair pair;   ///< the two loops, and their vertices that meet
  double size = 1;  ///< scale of the source
  /// Set if the source, placed undeformed at the hole, does not cut through the target.
  bool clear = true;
  std::vector<Note> notes;
};

/// Opens a hole of the shape of a source's boundary loop, to be passed on to `merge_meshes` with its size.
///
/// The loop, projected along its area vector, is laid onto the surface around the point. This uses the
/// discrete exponential map (Schmidt, Grimm and Wyvill 2006, "Interactive decal compositing with discrete
/// exponential maps"), about the target's normal averaged over the loop's radius. On curved surfaces the
/// outline is enlarged until it is as wide as the loop. Edges that are too long to represent the outline are
/// halved. All vertices outside the hole keep their positions; only those on its boundary may have moved,
/// along edges.
///
/// Throws Error(input), naming `surface_point`, `size` or the loop, in these cases:
/// - a vertex does not exist or is on the boundary;
/// - a point is farther from the surface than a twentieth of the target's diagonal;
/// - `source_loop` is no boundary loop or spans no area;
/// - a size is below a millionth of the target's;
/// - the hole of a given size would reach a boundary, an edge of three faces, or all round the surface;
/// - the surface is too narrow for a hole of a given size: less than 0.85 of the loop's width.
/// In the last two cases the id is merge.no_hole, whose field `largest` is the largest size that fits, or
/// merge.no_hole_at_any_size. A note of the error is the reason.
OpenedHole open_hole(const Mesh& target, const Mesh& source, const Drop& drop, const Context& context = {});

/// Refuses a boundary vertex: a hole around it would reach the boundary at any size.
void require_inner_point(const Mesh& target, const Drop& drop);

/// Opens a hole for a loop in exactly the size of `drop`, whatever the rest of the source does there. Returns
/// the reason where there is no room for it. `drop` must be valid for the target.
std::variant<OpenedHole, Note> open_hole_for_loop(const Mesh& target, const FlatLoop& loop, const Drop& drop,
                                                  const Context& context = {});

/// Predicts the pose of a dropped source before it is bent. It opens no hole, so that it can follow a
/// pointer: the constructor does the work that does not depend on the point.
class DropGuide {
 public:
  /// Throws Error(input), as `open_holes` does, for loops that are no boundary loops.
  DropGuide(std::shared_ptr<const Mesh> target, const Mesh& source,
            const std::vector<std::vector<Index>>& source_loops, const Context& context = {});

  /// Returns the similarity of the source's coordinates that lays its loop level with the surface around the
  /// point. Its scale is the size of `drop` (absent: 1); the loop is the constructor's. Throws Error(input), as
  /// `open_hole` does, for a point that it refuses.
  Eigen::Affine3d pose(const Drop& drop) const;

 private:
  struct Prepared;
  std::shared_ptr<const Prepared> prepared_;
};

}  // namespace meshgraft
