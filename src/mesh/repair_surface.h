#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <meshgraft/core/context.h>
#include <meshgraft/mesh/interpolate_attribute.h>
#include <meshgraft/mesh/mesh.h>
#include <meshgraft/mesh/repair.h>

#include "disjoint_sets.h"
#include "edge_table.h"

namespace meshgraft {

/// Faces on their way through a repair: their corners, and where each comes from.
struct RepairFaces {
  Faces faces;
  std::vector<Index> origin;  ///< per face, the given mesh's face that it is (a piece of), or that it continues
  std::vector<EdgePoint> corner;  ///< per corner, between corners of the given mesh
  Flags is_new;                   ///< per face, whether it fills a hole
  Flags is_turned;                ///< per face, whether it runs against the given one

  void add(std::span<const Index> face, std::span<const EdgePoint> corners, Index origin, bool is_new = false,
           bool is_turned = false);
  void keep(const RepairFaces& from, Index face);
};

/// A vertex that a repair adds: a copy of `origin` in the given mesh, or (-1) a new one; its attributes are
/// (1 − t) × those of one vertex of the surface + t × those of another one.
struct NewVertex {
  Eigen::RowVector3d position;
  Index origin = -1, from = -1, to = -1;
  double t = 0.5;
};

/// A mesh under repair: vertices are united, copied and added, faces replaced; every element knows where it
/// comes from, and every change is listed.
class RepairSurface {
 public:
  RepairSurface(const Mesh& given, const Context& context);

  const Context& context() const { return context_; }
  /// Positions and faces as they are now, without attributes. Vertices that were united or dropped are in no
  /// face.
  const Mesh& mesh() const { return mesh_; }
  const Faces& faces() const { return mesh_.faces; }
  const Points& positions() const { return mesh_.positions; }
  const RepairFaces& traced() const { return traced_; }
  const EdgeTable& edges() const;
  Index face_of(Index corner) const;  ///< that has the corner
  /// Unit length; zero for a face without area.
  Eigen::RowVector3d face_normal(Index face) const;
  double face_area(Index face) const;

  // Changes of the surface.
  void replace_faces(RepairFaces faces);
  void remove_faces(const Flags& doomed);
  /// Renames the vertices of all corners: `number[v]` for v. A vertex that gets another's name is united with
  /// it.
  void unite_vertices(DisjointSets& sets);
  /// Appends vertices and returns the first one's index.
  Index add_vertices(std::span<const NewVertex> vertices);
  /// The given mesh's vertex that a vertex is (a copy of), or -1.
  Index vertex_origin(Index vertex) const { return vertex_origin_[vertex]; }

  // What is told of it. Indices are of the surface as it is before the change.
  void report(const std::string& name, Domain domain, std::vector<Index> given_indices, Index count,
              const std::string& one, const std::string& many);
  void report_faces(const std::string& name, const Flags& chosen, const std::string& one,
                    const std::string& many);
  void note(const std::string& sentence);

  /// The repaired mesh with everything that is told of it. `remove_isolated`: whether vertices that no face of
  /// the given mesh had go.
  RepairResult finish(bool remove_isolated);

 private:
  std::vector<Index> place_vertices(bool remove_isolated, RepairResult& result);
  void carry_attributes(std::span<const Index> new_index, RepairResult& result);
  void turn_normals(Attribute& attribute, const RepairResult& result) const;

  struct Telling {
    RepairChange change;
    std::string one, many;
  };

  const Mesh& given_;
  const Context& context_;
  Mesh mesh_;
  RepairFaces traced_;  // its faces are in mesh_
  std::vector<Index> vertex_origin_;
  std::vector<EdgePoint> vertex_value_;  // of the given mesh's vertices
  std::vector<Index> stands_for_;        // per vertex, that it was united with (or itself)
  std::vector<Telling> tellings_;
  std::vector<std::string> notes_;
  mutable std::optional<EdgeTable> edges_;
  mutable std::vector<Index> face_of_;
};

/// Faces by the connected part that has them, parts in the order of their first face.
struct ConnectedComponents {
  std::vector<Index> of_face;
  std::vector<Index> faces;  ///< per part, how many
  std::vector<double> area;
};

ConnectedComponents components_of(const RepairSurface& surface);

/// Shortest edge at each vertex of a face, infinity at the others; edges without length do not count.
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
bool remove_debris(RepairSurface& surface, double debris_rel);
bool unify_winding(RepairSurface& surface);
bool fill_holes(RepairSurface& surface, const RepairOptions& options);

/// How the half-edges of one place are to be joined: pairs, those first that run against each other and go on
/// straightest. With an odd number one is left out.
std::vector<std::pair<Index, Index>> pair_up(const RepairSurface& surface, std::span<const Index> half_edges);

/// How far vertices may be apart to be one: given, else 1e-6 of the box.
double weld_reach(const RepairSurface& surface, std::optional<double> distance);

}  // namespace meshgraft
