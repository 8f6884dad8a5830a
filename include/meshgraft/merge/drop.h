#pragma once

#include <cstdint>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/merge/merge.h>
#include <meshgraft/merge/open_hole.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Pairs of faces that intersect after a merge (exact).
struct MergeIntersections {
  std::int64_t result = 0;  ///< of the result, where the source or the seam takes part
  std::int64_t source = 0;  ///< of the source as it came; 0 if the result has none

  bool any_new() const { return result > source; }
};
MergeIntersections count_intersections(const Mesh& source, const MergeResult& merged,
                                       const Context& context = {});

/// A part on a target that was opened for it.
struct DropResult {
  MergeResult merge;     ///< its index map of the target begins at the closed target
  MergeOptions options;  ///< those in force: the size, and the normal angle
  MergeIntersections intersections;
  std::vector<std::string> notes;  ///< sentences for people, beside the merge's own
};

/// Puts a part onto a surface without a hole: opens one of the shape of the source's loop (open_hole) and
/// grafts the part there in its size. Where no size is given, up to three smaller ones are tried as long as the
/// part turns inside out, or would stand clear of the target and does not. The rim bends until it is level with
/// the surface; where that turns it inside out and no normal angle is given, it bends half as far, or not at
/// all.
///
/// Throws what open_hole and merge_meshes throw, and Error(input) naming `surface_point` if the part turns
/// inside out even so (shape `similar`).
DropResult drop_part(const Mesh& target, const Mesh& source, const std::vector<Index>& source_loop,
                     const Drop& drop, const MergeOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
