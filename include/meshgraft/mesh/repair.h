#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>

namespace meshgraft {

/// Says what fills a hole. It is one choice and not two switches: a fill without inner vertices has nothing to
/// be faired.
enum class HoleFill {
  plain,    ///< triangles between the vertices around it
  refined,  ///< and vertices within, so that edges are about as long as around it
  faired,   ///< and these moved so that the surface goes on smoothly
};

/// Which steps a repair takes, in their order, and how far each goes.
struct RepairOptions {
  /// Faces that name a vertex which does not exist, vertices with a non-finite coordinate and their faces.
  bool remove_invalid = true;
  /// Repeated corners, faces that come twice, faces without area.
  bool clean_faces = true;
  /// Connected parts all of whose faces lie on faces of another part.
  bool remove_duplicate_shells = true;
  /// Boundary edges that lie on each other, and boundary vertices that lie on a boundary edge (T-junctions).
  bool weld = true;
  /// How far apart two vertices may be to be welded, model units. Absent: 1e-6 of the bounding box's diagonal,
  /// and nowhere more than a tenth of the shortest edge there (half of it where a distance is given).
  std::optional<double> weld_distance{};
  /// Edges of three or more faces and vertices of several fans are taken apart.
  bool split_non_manifold = true;
  /// Parts with fewer faces and less area than `debris_rel` × the largest part's.
  bool remove_debris = true;
  double debris_rel = 0.01;
  /// Neighbouring faces are consistently oriented, closed parts outward (but not what lies inside another
  /// closed part).
  bool unify_winding = true;
  /// Boundary loops of at most this many edges are closed. Absent: 24, and only where the hole's area is at
  /// most 0.5 % of its part's: an opening that is meant stays. 0: none.
  std::optional<Index> hole_edges{};
  /// How holes are filled.
  HoleFill hole_fill = HoleFill::plain;
  /// Vertices that no face has.
  bool remove_isolated = true;
};

/// One kind of change, with where it was made.
struct RepairChange {
  std::string name;  ///< stable identifier, e.g. "welded-vertex"
  Index count = 0;
  Domain domain = Domain::vertex;  ///< what `indices` refer to
  std::vector<Index> indices{};  ///< of the mesh that was given, ascending; empty where nothing of it is meant
  std::string description{};     ///< one clause for people, e.g. "12 vertices were welded to others"
};

struct RepairResult {
  Mesh mesh;
  std::vector<RepairChange>
      changes;  ///< in the order of the steps; none: `mesh` is the given one, its source too
  IndexMap vertex,
      face;  ///< old → new; several may go to one; -1 removed; of several copies or pieces the first
  std::vector<Index> vertex_origin, face_origin;  ///< new → old; -1 for what fills a hole
  std::vector<std::string> notes;  ///< sentences for people: what could not be mended, or was lost

  bool changed() const { return !changes.empty(); }
  const RepairChange* find(std::string_view name) const;
};

/// Makes a mesh that every command takes of one that may carry any defect (docs/repair.md): cleaned, welded,
/// edges and vertices manifold, consistently oriented, small holes closed. Positions are kept, vertices and
/// faces stay in their order; what is new comes last. Attributes go along; one per vertex that differs between
/// welded vertices becomes one per corner (but colours, which keep the first one's). A mesh without defects
/// comes back as it is, and repairing the result once more changes nothing. The result does not depend on the
/// number of threads.
///
/// Throws Error(input) for options out of range, Error(cancelled).
RepairResult repair(const Mesh& mesh, const RepairOptions& options = {}, const Context& context = {});

}  // namespace meshgraft
