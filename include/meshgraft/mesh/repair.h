#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/core/error.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Ways to fill a hole. They are one choice and not two switches, because a fill without inner vertices has
/// nothing to fair.
enum class HoleFill {
  plain,    ///< triangles between the vertices of its boundary
  refined,  ///< with inner vertices, so that edges are about as long as on its boundary
  faired,   ///< with inner vertices that are moved so that the surface continues smoothly
};

/// The steps of a repair, in their order, and their limits.
struct RepairOptions {
  /// Remove faces with the index of a vertex that does not exist, and vertices with a non-finite coordinate or
  /// far beyond all others (outlying_vertex of check_mesh) with their faces.
  bool remove_invalid = true;
  /// Remove repeated corners, duplicate faces and faces without area.
  bool clean_faces = true;
  /// Remove connected components all of whose faces lie on faces of another component.
  bool remove_duplicate_shells = true;
  /// Weld boundary edges that coincide, and boundary vertices that lie on a boundary edge (T-junctions).
  bool weld = true;
  /// Largest distance of two vertices that are welded, model units. It is nowhere more than half of the
  /// shortest edge there. Absent: 1e-6 of the bounding box's diagonal, and nowhere more than a tenth of the
  /// shortest edge there.
  std::optional<double> weld_distance{};
  /// Take apart edges of three or more faces and vertices of several fans.
  bool split_non_manifold = true;
  /// Remove connected components with fewer faces and less area than `debris_rel` × the largest one's.
  bool remove_debris = true;
  double debris_rel = 0.01;
  /// Orient neighbouring faces consistently and closed components outward, except those that lie inside
  /// another closed component.
  bool unify_winding = true;
  /// Largest number of edges of a hole that is closed; 0: none. Absent: 24, and only if the hole's area is at
  /// most 0.5 % of the components' around it, so that intended openings stay.
  std::optional<Index> hole_edges{};
  /// Way to fill holes.
  HoleFill hole_fill = HoleFill::plain;
  /// Remove vertices that belong to no face.
  bool remove_isolated = true;
};

/// The kinds of changes that a repair makes.
enum class RepairChangeKind {
  removed_out_of_range_face,  ///< faces with the index of a vertex that does not exist were removed
  removed_non_finite_face,    ///< faces of a vertex with a non-finite coordinate were removed
  removed_non_finite_vertex,  ///< vertices with a non-finite coordinate were removed
  removed_outlying_vertex,    ///< vertices far beyond all others were removed with their faces
  mended_degenerate_face,     ///< repeated corners were removed, or the face with them
  removed_duplicate_face,     ///< faces with the corners of another were removed
  removed_zero_area_face,     ///< faces without area were removed
  removed_duplicate_shell,    ///< connected components that lie on another were removed
  welded_vertex,              ///< boundary vertices were welded to others at their place
  split_t_junction,           ///< boundary edges were split at boundary vertices that lie on them
  split_non_manifold_vertex,  ///< vertices with several fans were split
  removed_non_manifold_face,  ///< faces that left no manifold edge were removed
  removed_debris,             ///< small connected components were removed
  turned_face,                ///< faces were turned to agree with their neighbours
  turned_component,           ///< closed components were turned outward
  rejoined_vertex,            ///< vertices that had been split were joined again
  filled_hole,                ///< holes were filled
  removed_isolated_vertex,    ///< vertices of no face were removed
};

/// Returns the name of a kind in reports, e.g. "welded-vertex".
std::string_view name_of(RepairChangeKind kind);

/// The changes of one kind, and the elements that they concern.
struct RepairChange {
  RepairChangeKind kind = RepairChangeKind::welded_vertex;
  Index count = 0;
  Domain domain = Domain::vertex;  ///< elements that `indices` refer to
  /// Elements of the given mesh, ascending; empty where none of its own are meant.
  std::vector<Index> indices{};
  Note note;  ///< the fact, e.g. "mesh.welded_vertex"; its field `count` is the one above

  /// Returns one clause for people, e.g. "2 boundary vertices were welded to others at their place".
  std::string description() const { return note.text(); }
};

struct RepairResult {
  Mesh mesh;
  /// Changes in the order of the steps. If there are none, `mesh` is the given one, with its source.
  std::vector<RepairChange> changes;
  /// Old → new, or -1 where one was removed. Several may map to one; one with several copies or pieces maps
  /// to the first of them.
  IndexMap vertex, face;
  std::vector<Index> vertex_origin, face_origin;  ///< new → old; -1 for elements that fill a hole
  std::vector<Note> notes;                        ///< about defects that remain and data that were lost

  bool changed() const { return !changes.empty(); }
  /// Returns the changes of that kind, or null.
  const RepairChange* find(RepairChangeKind kind) const;
};

/// Repairs a mesh with any defects so that every command accepts it (docs/repair.md), except one whose
/// coordinates are too large, for which scaling it is the only remedy. The result is cleaned
/// and welded, its edges and vertices are manifold, it is consistently oriented, and small holes are closed.
/// Positions are kept, and vertices and faces stay in their order; new ones come last. Attributes are kept. A
/// vertex attribute that differs between welded vertices becomes one per corner; of colours the first one's
/// is kept. A mesh without defects is returned unchanged, and repairing a result again changes nothing. The
/// result does not depend on the number of threads.
///
/// Throws Error(input) for options out of range, Error(cancelled).
RepairResult repair(const Mesh& mesh, const RepairOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
