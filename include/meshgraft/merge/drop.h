#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/fact.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/merge/open_hole.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Numbers of pairs of faces that intersect after a merge (exact).
struct MergeIntersections {
  std::int64_t result = 0;  ///< pairs of the result with a face of the source or the seam
  std::int64_t source = 0;  ///< pairs of the given source; 0 if the result has none

  bool any_new() const { return result > source; }
};
/// Counts the intersecting pairs of faces after a merge and, if there are any, those of the source before it.
MergeIntersections count_intersections(const Mesh& source, const MergeResult& merged,
                                       const Context& context = {});

/// A source grafted onto a target in which a hole was opened for it.
struct DropResult {
  MergeResult merge;     ///< merge; its index map of the target starts from the closed target
  MergeOptions options;  ///< the options that were used, with the size and the normal angle that were found
  MergeIntersections intersections;
  std::vector<Note> notes;  ///< in addition to the merge's own
};

/// Grafts a source onto a surface without a hole. It opens a hole of the shape of the source's loop
/// (`open_hole`), and grafts the source there in its size.
///
/// Without a given size up to three smaller ones are tried. That happens as long as the graft turns inside
/// out, or intersects the target although the undeformed source would stand clear of it. The source bends
/// near its loop until it is level with the surface. Where this turns it inside out and no normal angle is
/// given, it bends half as far, or not at all.
///
/// Throws what `open_hole` and `merge_meshes` throw. Throws Error(input) with the id
/// merge.dropped_source_inverted, naming `surface_point`, if the graft turns inside out in all tries (shape
/// `similar`).
DropResult drop_part(const Mesh& target, const Mesh& source, const Drop& drop, const MergeOptions& options = {},
                     const Context& context = {});

}  // namespace meshgraft
