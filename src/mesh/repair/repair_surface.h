#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/repair.h>

#include "mesh/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "mesh/interpolate_attribute.h"

namespace meshgraft {

/// Faces under repair, with their origins in the given mesh.
struct RepairFaces {
  Faces faces;
  std::vector<Index> origin;      ///< per face: the given mesh's face that it is, is part of, or continues
  std::vector<EdgePoint> corner;  ///< per corner: between corners of the given mesh
  Flags is_new;                   ///< per face: whether it fills a hole
  Flags is_turned;                ///< per face: whether it is reversed against the given one

  void add(std::span<const Index> face, std::span<const EdgePoint> corners, Index origin, bool is_new = false,
           bool is_turned = false);
  void keep(const RepairFaces& from, Index face);
};

/// A vertex that a repair adds: a copy of vertex `origin` of the given mesh, or a new one (-1). Its
/// attributes are (1 − t) × those of vertex `from` of the surface + t × those of vertex `to`.
struct NewVertex {
  Eigen::RowVector3d position;
  Index origin = -1, from = -1, to = -1;
  double t = 0.5;
};

/// A mesh under repair. Vertices are united, copied and added, and faces are replaced. Every element records
/// its origin, and every change is reported.
class RepairSurface {
 public:
  RepairSurface(const Mesh& given, const Context& context);

  const Context& context() const { return context_; }
  /// Current positions and faces, without attributes. Vertices that were united or dropped belong to no face.
  const Mesh& mesh() const { return mesh_; }
  const Faces& faces() const { return mesh_.faces; }
  const Points& positions() const { return mesh_.positions; }
  const RepairFaces& traced() const { return traced_; }
  const EdgeTable& edges() const;
  Index face_of(Index corner) const;  ///< the face that has the corner
  /// Returns the unit normal, or zero for a face without area.
  Eigen::RowVector3d face_normal(Index face) const;
  double face_area(Index face) const;

  // Changes of the surface.
  void replace_faces(RepairFaces faces);
  void remove_faces(const Flags& doomed);
  /// Renames the vertices of all corners to the roots of their sets, which unites the vertices of each set.
  void unite_vertices(DisjointSets& sets);
  /// Appends vertices and returns the first one's index.
  Index add_vertices(std::span<const NewVertex> vertices);
  /// Returns the given mesh's vertex that a vertex is or copies, or -1.
  Index vertex_origin(Index vertex) const { return vertex_origin_[vertex]; }

  // Reports of changes. Indices refer to the surface before the change.
  void report(RepairChangeKind kind, Domain domain, std::vector<Index> given_indices, Index count);
  void report_faces(RepairChangeKind kind, const Flags& chosen);
  void report_vertices(RepairChangeKind kind, const Flags& chosen);
  /// Adds a note that is not there already.
  void note(const Note& note);

  /// Returns the repaired mesh with all reports. `remove_isolated` removes the vertices that are in no face
  /// of the given mesh.
  RepairResult finish(bool remove_isolated);

 private:
  std::vector<Index> place_vertices(bool remove_isolated, RepairResult& result);
  void carry_attributes(std::span<const Index> new_index, RepairResult& result);
  void turn_normals(Attribute& attribute, const RepairResult& result) const;

  const Mesh& given_;
  const Context& context_;
  Mesh mesh_;
  RepairFaces traced_;  // its faces are in mesh_
  std::vector<Index> vertex_origin_;
  std::vector<EdgePoint> vertex_value_;  // between vertices of the given mesh
  std::vector<Index> stands_for_;        // per vertex: the one that it was united with, or itself
  std::vector<RepairChange> changes_;
  std::vector<Note> notes_;
  mutable std::optional<EdgeTable> edges_;
  mutable std::vector<Index> face_of_;
};

/// Returns the note about that number of changes of one kind.
Note note_of(RepairChangeKind kind, Index count);

/// Connected components of faces, in the order of their first faces.
struct ConnectedComponents {
  std::vector<Index> of_face;
  std::vector<Index> faces;  ///< per component: number of faces
  std::vector<double> area;
};

ConnectedComponents components_of(const RepairSurface& surface);

/// Returns the shortest edge at each vertex of a face, and infinity at other vertices. Edges without length
/// do not count.
std::vector<double> shortest_edges(const RepairSurface& surface);

// The steps. Each returns whether it changed anything.
bool remove_invalid(RepairSurface& surface);
bool clean_corners(RepairSurface& surface);
bool remove_duplicate_faces(RepairSurface& surface);
bool remove_zero_area(RepairSurface& surface, bool may_split_edges);
bool remove_duplicate_shells(RepairSurface& surface);
bool stitch(RepairSurface& surface, std::optional<double> distance);
bool split_t_junctions(RepairSurface& surface, std::optional<double> distance);
bool split_non_manifold(RepairSurface& surface);
/// Closes holes between components. They are part of one surface then, however small.
bool fill_cracks(RepairSurface& surface, const RepairOptions& options);
bool remove_debris(RepairSurface& surface, double debris_rel);
bool unify_winding(RepairSurface& surface);
bool fill_holes(RepairSurface& surface, const RepairOptions& options);

/// Two half-edges at one position. Those that fit better have a lower score.
struct ScoredPair {
  double score;
  std::array<Index, 2> half_edges;
};

/// No pair has a higher score.
inline constexpr double worst_pair_score = 10;

/// Returns the pairs of half-edges at one position that may be joined. Pairs that run in opposite directions
/// have lower scores than others, and then those that continue most nearly straight.
std::vector<ScoredPair> possible_pairs(const RepairSurface& surface, std::span<const Index> half_edges);

/// Pairs half-edges for joining, lowest scores first. With an odd number at a position one is left out.
std::vector<std::array<Index, 2>> pair_up(std::vector<ScoredPair> possible);
std::vector<std::array<Index, 2>> pair_up(const RepairSurface& surface, std::span<const Index> half_edges);

/// Returns for each boundary vertex the smallest one at its position, exactly or within the weld distance; -1
/// for other vertices.
std::vector<Index> boundary_positions(const RepairSurface& surface, std::optional<double> distance);

/// Returns how far apart merged vertices may be: `distance`, or by default 1e-6 of the box diagonal.
double weld_distance(const RepairSurface& surface, std::optional<double> distance);

}  // namespace meshgraft
