#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/merge/merge_options.h>
#include <meshgraft/merge/merge_report.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

struct MergeResult {
  Mesh mesh;
  IndexMap target, source;       ///< vertices of the inputs → `mesh`, or -1 where one was removed
  Points grafted;                ///< the source's positions after the solve, before the seam (n×3)
  std::vector<Index> new_faces;  ///< faces of the seams
  std::vector<Index> band;       ///< vertices of `mesh` around the seams that fairing could move
  MergeReport report;
};

/// Grafts `source` onto `target` across pairs of boundary loops (Fu & Tai 2005, section 5). The target is not
/// moved; outside the bands around the seams it keeps its coordinates bit for bit.
///
/// Throws Error(input), naming the pair and the remedy, in these cases:
/// - a loop is not a simple boundary loop;
/// - loops meet;
/// - a connected component of the source has no loop (merge.component_without_pair);
/// - correspondences cross (merge.matches_cross);
/// - the orientations disagree (merge.orientations_disagree);
/// - several pairs turn the source inside out, and `retry` is set (merge.pairs_invert_source).
/// Throws Error(unsolvable) and Error(cancelled).
MergeResult merge_meshes(const Mesh& target, const Mesh& source, std::span<const MergePair> pairs,
                         const MergeOptions& options = {}, const Context& context = {});

/// Returns for each pair the starts that a person may have meant, the most probable first; `merge_meshes` would
/// take the first. They are up to five. A pair has none where its start is given or follows from other pairs of
/// the same component, and where the pose is kept. Throws Error(input) like `merge_meshes` for unusable loops.
std::vector<std::vector<StartCandidate>> find_starts(const Mesh& target, const Mesh& source,
                                                     std::span<const MergePair> pairs,
                                                     const MergeOptions& options = {});

/// Numbers of pairs of faces that intersect after a merge (exact).
struct MergeIntersections {
  std::int64_t result = 0;  ///< pairs of the result that touch a vertex of the source or the seam
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
  std::optional<BaseReport> base;  ///< the plane that opened the source, if it was closed
  std::vector<Note> notes;         ///< in addition to the merge's own
};

/// Grafts a source onto a surface without a hole. It opens a hole of the shape of the source's loop, and
/// grafts the source there in its size.
///
/// Without a given size up to three smaller ones are tried. That happens as long as the graft turns inside
/// out, or intersects the target although the undeformed source would not. The source bends
/// near its loop until it is level with the surface. Where this turns it inside out and no normal angle is
/// given, it bends half as far, or not at all.
///
/// A closed source is opened first: a plane cuts off its base (`DropBase`). So is one with loops of which none is
/// named, and one for which values of a base are given. Each loop of the
/// section meets the surface, so that a source may stand on several feet. Without a
/// height, up to five planes are tried until the drop is possible and the result has no new intersections.
/// Vertices that were cut away map to -1, and in `grafted` they follow the similarity of the others; reported
/// pairs name vertices of the given source.
///
/// Throws what `merge_meshes` throws. Throws Error(input) where the source has no base, or where the base's
/// plane does not cut it in clean loops (location `base`; the ids begin with merge.base or are merge.no_base).
/// Throws Error(input), naming `surface_point`, `size` or the loop, in these cases:
/// - a vertex does not exist or is on the boundary;
/// - a point is farther from the surface than a twentieth of the target's diagonal;
/// - `source_loop` is no boundary loop or spans no area;
/// - a size is below a millionth of the target's;
/// - the hole of a given size would reach a boundary, an edge of three faces, or all round the surface;
/// - the surface is too narrow for a hole of a given size: less than 0.85 of the loop's width;
/// - the graft turns inside out in all tries (shape `similar`; merge.dropped_source_inverted).
/// For a hole that does not fit, the id is merge.no_hole, whose field `largest` is the largest size that fits,
/// or merge.no_hole_at_any_size. A note of the error is the reason.
DropResult drop_source(const Mesh& target, const Mesh& source, const Drop& drop,
                       const MergeOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
